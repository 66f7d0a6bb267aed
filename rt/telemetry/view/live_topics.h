// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rt/loop/tick_sink.h"
#include "rt/telemetry/recording/run_messages.h"

namespace sandrunner {

/// The topics of a run while it goes on, from the thread of its ticks to the one that serves
/// Foxglove. Only topics with a subscriber are encoded. As with ViewFeed, a reader that falls
/// behind continues with the newest message, and delays nothing.
class LiveTopics final : public TickSink {
 public:
  struct Message {
    RunTopic topic;
    std::uint64_t time_ns = 0;  ///< since 1970
    std::string cdr;
  };
  /// Messages of about a second.
  static constexpr std::size_t kMostBehind = 600;

  explicit LiveTopics(const RobotDescription& robot) : robot_(robot) {}

  // From one ordinary thread:
  void begin(std::int64_t start_ns) override;
  void add(const TickRecord& tick) override;
  void note(std::uint64_t tick, const std::string& kind, const std::string& text) override;
  void end() override;

  // From any thread:
  /// One reader more, or less, of this topic.
  void subscribe(RunTopic topic);
  void unsubscribe(RunTopic topic);
  /// Number of the next message, for a reader that comes now.
  std::uint64_t join() const;
  /// The next message from number `place` on of a topic that is in `topics`; `place` moves behind
  /// it. Null: there is none yet.
  std::shared_ptr<const Message> next(std::uint64_t& place, const RunTopics& topics) const;
  /// The message of a topic that has one. Null: the run has not begun.
  std::shared_ptr<const Message> said_once(RunTopic topic) const;
  /// Of the latest tick, since 1970; 0: the run has not begun.
  std::uint64_t time_ns() const;

 private:
  void follow_readers();
  void send_batch();

  const RobotDescription robot_;
  mutable std::mutex mutex_;  // of the rest
  std::array<int, kNumRunTopics> readers_{};
  std::optional<RunMessages> messages_;  // from begin() on
  std::vector<TickRecord> batch_;
  std::vector<std::shared_ptr<const Message>> said_once_;
  std::deque<std::shared_ptr<const Message>> queue_;
  std::uint64_t end_ = 0;  // number of the message after the queue
  std::uint64_t time_ns_ = 0;
};

}  // namespace sandrunner
