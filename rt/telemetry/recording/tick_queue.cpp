// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/tick_queue.h"

#include <utility>

namespace sandrunner {

TickQueue::TickQueue(std::size_t batch_ticks, std::size_t batches, WhenFull when_full)
    : batch_ticks_(batch_ticks), batches_(batches), when_full_(when_full) {
  batch_.reserve(batch_ticks_);
}

void TickQueue::add(const TickRecord& tick) {
  batch_.push_back(tick);
  if (batch_.size() == batch_ticks_) hand_over();
}

void TickQueue::hand_over() {
  if (batch_.empty()) return;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (when_full_ == WhenFull::kWait)
      changed_.wait(lock, [&] { return queue_.size() < batches_; });
    if (queue_.size() < batches_) {
      queue_.push_back(std::move(batch_));
    } else {
      dropped_ += batch_.size();
    }
  }
  changed_.notify_all();
  batch_.clear();
  batch_.reserve(batch_ticks_);
}

void TickQueue::finish() {
  hand_over();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_ = true;
  }
  changed_.notify_all();
}

std::optional<TickQueue::Batch> TickQueue::take() {
  std::optional<Batch> batch;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return !queue_.empty() || finished_; });
    if (queue_.empty()) return batch;
    batch = std::move(queue_.front());
    queue_.pop_front();
  }
  changed_.notify_all();
  return batch;
}

}  // namespace sandrunner
