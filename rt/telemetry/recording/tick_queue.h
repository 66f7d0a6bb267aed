// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Ticks from one ordinary thread to another, in batches.
class TickQueue {
 public:
  using Batch = std::vector<TickRecord>;

  /// Holds up to `batches` of `batch_ticks` each. If it is full, the giver waits if `wait` is set;
  /// else the newest batch is dropped and counted.
  TickQueue(std::size_t batch_ticks, std::size_t batches, bool wait);

  // The giver:
  void add(const TickRecord& tick);
  /// Hands over what is there. Nothing may be added afterwards.
  void finish();

  // The taker:
  /// The next batch; waits for it. Nothing: all is taken, and finish() was called.
  std::optional<Batch> take() { return take(true); }
  /// The next batch, if there is one now.
  std::optional<Batch> take_at_once() { return take(false); }

  /// Ticks. Of the giver's thread, and of any after finish().
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void hand_over();
  std::optional<Batch> take(bool wait);

  const std::size_t batch_ticks_, batches_;
  const bool wait_;
  Batch batch_;  // of the giver
  std::uint64_t dropped_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> queue_;
  bool finished_ = false;
};

}  // namespace sandrunner
