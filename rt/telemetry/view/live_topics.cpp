// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/live_topics.h"

#include <utility>

namespace sandrunner {

void LiveTopics::begin(std::int64_t start_ns) {
  const std::lock_guard lock(mutex_);
  const auto keep = [this](const RunMessages::Message& message) {
    const auto bytes = message.content.bytes();
    auto kept = std::make_shared<const Message>(
        Message{message.topic,
                message.time_ns,
                {reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
    if (run_topics()[index_of(message.topic)].once) {
      said_once_.push_back(std::move(kept));
      return;
    }
    if (queue_.size() == kMostBehind) queue_.pop_front();
    queue_.push_back(std::move(kept));
    ++end_;
  };
  messages_.emplace(robot_, start_ns, 0, keep);
  messages_->begin();
  follow_readers();
  time_ns_ = messages_->time_ns(0);
}

void LiveTopics::add(const TickRecord& tick) {
  const std::lock_guard lock(mutex_);
  time_ns_ = messages_->time_ns(tick.input.sensors.tick);
  if (readers_[index_of(RunTopic::kTicks)] > 0) {
    batch_.push_back(tick);
    if (batch_.size() == kTicksPerMessage) send_batch();
  }
  messages_->add(tick);
}

void LiveTopics::note(std::uint64_t tick, const std::string& kind, const std::string& text) {
  const std::lock_guard lock(mutex_);
  messages_->add_event(tick, kind, text);
}

void LiveTopics::end() {
  const std::lock_guard lock(mutex_);
  if (messages_) send_batch();
}

void LiveTopics::send_batch() {
  if (!batch_.empty()) messages_->add_batch(batch_);
  batch_.clear();
}

void LiveTopics::subscribe(RunTopic topic) {
  const std::lock_guard lock(mutex_);
  ++readers_[index_of(topic)];
  follow_readers();
}

void LiveTopics::unsubscribe(RunTopic topic) {
  const std::lock_guard lock(mutex_);
  if (--readers_[index_of(topic)] == 0 && topic == RunTopic::kTicks) batch_.clear();
  follow_readers();
}

void LiveTopics::follow_readers() {
  if (!messages_) return;
  RunTopics wanted;
  for (std::size_t i = 0; i < kNumRunTopics; ++i) wanted[i] = readers_[i] > 0;
  messages_->want(wanted);
}

std::uint64_t LiveTopics::join() const {
  const std::lock_guard lock(mutex_);
  return end_;
}

std::shared_ptr<const LiveTopics::Message> LiveTopics::next(std::uint64_t& place,
                                                            const RunTopics& topics) const {
  const std::lock_guard lock(mutex_);
  const std::uint64_t begin = end_ - queue_.size();
  if (place < begin) place = end_ - 1;  // behind: with the newest
  while (place < end_) {
    const auto& message = queue_[place++ - begin];
    if (topics[index_of(message->topic)]) return message;
  }
  return nullptr;
}

std::shared_ptr<const LiveTopics::Message> LiveTopics::said_once(RunTopic topic) const {
  const std::lock_guard lock(mutex_);
  for (const auto& message : said_once_) {
    if (message->topic == topic) return message;
  }
  return nullptr;
}

std::uint64_t LiveTopics::time_ns() const {
  const std::lock_guard lock(mutex_);
  return time_ns_;
}

}  // namespace sandrunner
