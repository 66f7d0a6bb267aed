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

/// Hands ticks from one ordinary thread to another, in batches.
class TickQueue {
 public:
  using Batch = std::vector<TickRecord>;

  /// Holds up to `batches` of `batch_ticks` each. When it is full, the giver waits if `wait` is
  /// set; otherwise the newest batch is dropped and counted.
  TickQueue(std::size_t batch_ticks, std::size_t batches, bool wait);

  // For the giver:
  void add(const TickRecord& tick);
  /// Hands over the last, partial batch. Nothing may be added afterwards.
  void finish();

  // For the taker:
  /// Waits for the next batch. Nothing: finish() was called, and all batches were taken.
  std::optional<Batch> take() { return take(true); }
  /// The next batch if there is one, without waiting.
  std::optional<Batch> take_at_once() { return take(false); }

  /// Number of dropped ticks. For the giver's thread; after finish(), for any thread.
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void hand_over();
  std::optional<Batch> take(bool wait);

  const std::size_t batch_ticks_, batches_;
  const bool wait_;
  Batch batch_;  // only the giver uses it
  std::uint64_t dropped_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> queue_;
  bool finished_ = false;
};

}  // namespace sandrunner
