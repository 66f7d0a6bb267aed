// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/recorder.h"

#include <fmt/format.h>

#include <cstddef>
#include <span>
#include <utility>

#include "rt/core/errors.h"
#include "rt/core/mode_machine.h"
#include "rt/telemetry/recording/ros_messages.h"
#include "rt/tick_fields.h"

namespace sandrunner {
namespace {

constexpr std::size_t kBatchTicks = 40;
constexpr std::size_t kQueuedBatches = 200;  // two seconds
constexpr const char* kEventIdl =
    "module sandrunner {\n  struct Event {\n    unsigned long long tick;\n    string kind;\n"
    "    string text;\n  };\n};\n";

const char* request_name(ModeRequest request) {
  switch (request) {
    case ModeRequest::kNone:
      break;
    case ModeRequest::kPassive:
      return "passive";
    case ModeRequest::kDamp:
      return "damp";
    case ModeRequest::kStand:
      return "stand";
    case ModeRequest::kWalk:
      return "walk";
    case ModeRequest::kResetFault:
      return "reset_fault";
  }
  return "none";
}

McapMap qos() { return {{"offered_qos_profiles", ""}}; }

}  // namespace

Recorder::Recorder(const std::string& path, const RecordingInfo& info,
                   const RecordingLimits& limits, bool wait)
    : start_time_ns_(info.start_time_ns), limits_(limits), wait_(wait), writer_(path) {
  writer_.write_metadata({kRunMetadata,
                          {{"build", info.build},
                           {"start_mode", info.start_mode},
                           {"clock", info.clock},
                           {"start_time_ns", fmt::format("{}", info.start_time_ns)}}});
  const auto attach = [&](const char* name, const char* type, const std::string& data) {
    if (data.empty()) return;
    writer_.write_attachment({.log_time_ns = time_ns(0),
                              .create_time_ns = 0,
                              .name = name,
                              .media_type = type,
                              .data = data});
  };
  attach(kConfigAttachment, "application/toml", info.config);
  attach(kPolicyAttachment, "application/octet-stream", info.policy);
  attach(kRobotAttachment, "application/xml", info.robot);
  const auto own = [&](const char* topic, const char* name, const std::string& idl) {
    return writer_.add_channel(writer_.add_schema(name, "omgidl", idl), topic, "cdr", qos());
  };
  channels_.ticks = own(kTicksTopic, "sandrunner::TickBatch", tick_idl());
  channels_.events = own(kEventsTopic, "sandrunner::Event", kEventIdl);
  const auto ros = [&](const RosTopic& topic) {
    return writer_.add_channel(writer_.add_schema(topic.schema, "ros2msg", topic.text), topic.topic,
                               "cdr", qos());
  };
  channels_.joint_states = ros(joint_state_topic());
  channels_.imu = ros(imu_topic());
  channels_.odometry = ros(odometry_topic());
  channels_.transforms = ros(transform_topic());
  batch_.reserve(kBatchTicks);
  thread_ = std::thread([this] { work(); });
}

Recorder::~Recorder() { close(); }

void Recorder::add(const TickRecord& tick) {
  batch_.push_back(tick);
  if (batch_.size() == kBatchTicks) hand_over();
}

void Recorder::hand_over() {
  if (batch_.empty()) return;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (wait_) changed_.wait(lock, [&] { return queue_.size() < kQueuedBatches; });
    if (queue_.size() < kQueuedBatches) {
      queue_.push_back(std::move(batch_));
    } else {
      dropped_ += batch_.size();
    }
  }
  changed_.notify_all();
  batch_.clear();
  batch_.reserve(kBatchTicks);
}

RecordingResult Recorder::close() {
  if (thread_.joinable()) {
    hand_over();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    thread_.join();
    result_.dropped = dropped_;
    result_.bytes = writer_.bytes_written();
  }
  return result_;
}

void Recorder::work() {
  for (;;) {
    Batch batch;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [&] { return !queue_.empty() || closing_; });
      if (queue_.empty()) break;
      batch = std::move(queue_.front());
      queue_.pop_front();
    }
    changed_.notify_all();
    if (stopped_) continue;
    try {
      write(batch);
    } catch (const InputError& error) {
      stop(error.what());
    }
  }
  try {
    writer_.close();
  } catch (const InputError& error) {
    stop(error.what());
  }
}

void Recorder::write(const Batch& batch) {
  const std::uint64_t first = batch.front().input.sensors.tick;
  const auto message = [&](std::uint16_t channel, std::uint64_t sequence, std::uint64_t tick,
                           const CdrWriter& cdr) {
    writer_.write_message({.channel_id = channel,
                           .sequence = static_cast<std::uint32_t>(sequence),
                           .log_time_ns = time_ns(tick),
                           .publish_time_ns = time_ns(tick),
                           .data = cdr.bytes()});
  };
  CdrWriter ticks;
  ticks.number(++batches_).number(static_cast<std::uint32_t>(batch.size()));
  ticks.block(std::as_bytes(std::span(batch)), 8);
  message(channels_.ticks, batches_, first, ticks);
  result_.ticks += batch.size();

  for (const TickRecord& tick : batch) {
    odometry_.add(tick);
    write_events(tick);
    const std::uint64_t number = tick.input.sensors.tick;
    if (number % kTicksPerPolicyStep != 0) continue;
    const auto now = static_cast<std::int64_t>(time_ns(number));
    const std::uint64_t sequence = number / kTicksPerPolicyStep;
    message(channels_.joint_states, sequence, number, joint_state_message(tick, now));
    message(channels_.imu, sequence, number, imu_message(tick, now));
    message(channels_.odometry, sequence, number, odometry_message(odometry_, now));
    message(channels_.transforms, sequence, number, transform_message(odometry_, now));
  }
  if (first - last_flush_tick_ >= kControlHz / 2) {
    writer_.flush();
    last_flush_tick_ = first;
  }
  if (writer_.bytes_written() > limits_.bytes) stop("the limit of its size is reached");
  if (static_cast<double>(first) * kControlPeriod_s > limits_.time_s) {
    stop("the limit of its time is reached");
  }
}

void Recorder::write_events(const TickRecord& tick) {
  const auto event = [&](const char* kind, const std::string& text) {
    CdrWriter cdr;
    cdr.number(tick.input.sensors.tick).text(kind).text(text);
    writer_.write_message({.channel_id = channels_.events,
                           .sequence = static_cast<std::uint32_t>(++events_),
                           .log_time_ns = time_ns(tick.input.sensors.tick),
                           .publish_time_ns = time_ns(tick.input.sensors.tick),
                           .data = cdr.bytes()});
  };
  const auto mode = static_cast<std::uint64_t>(tick.output.mode);
  const std::uint64_t request = tick.input.command.request_id;
  if (!has_last_ || mode != last_mode_) event("mode", mode_name(tick.output.mode));
  if (request != last_request_) {
    event("request", request_name(tick.input.command.request));
  }
  for (int bit = 0; bit < kNumFaults; ++bit) {
    const std::uint64_t mask = std::uint64_t{1} << bit;
    if ((tick.output.faults & mask) != 0 && (last_faults_ & mask) == 0) {
      event("fault", fault_name(static_cast<Fault>(mask)));
    }
  }
  if (tick.skipped > 0) event("skipped", fmt::format("{} ticks", tick.skipped));
  has_last_ = true;
  last_mode_ = mode;
  last_faults_ = tick.output.faults;
  last_request_ = request;
}

void Recorder::stop(const std::string& reason) {
  if (stopped_) return;
  stopped_ = true;
  result_.stopped_because = reason;
  try {
    writer_.close();
  } catch (const InputError&) {  // the disk is full: what is there is readable
  }
}

std::uint64_t Recorder::time_ns(std::uint64_t tick) const noexcept {
  return static_cast<std::uint64_t>(start_time_ns_) + tick * (1'000'000'000 / kControlHz);
}

}  // namespace sandrunner
