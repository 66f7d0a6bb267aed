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

/// What a queue does with a batch when it is full: add() waits, which only slows a run in lockstep
/// down, or the batch is dropped and its ticks are counted.
enum class WhenFull { kWait, kDrop };

/// Hands ticks from one ordinary thread to another, in batches.
class TickQueue {
 public:
  using Batch = std::vector<TickRecord>;

  /// Holds up to `batches` of `batch_ticks` each.
  TickQueue(std::size_t batch_ticks, std::size_t batches, WhenFull when_full);

  // For the giver:
  void add(const TickRecord& tick);
  /// Hands over the last, partial batch. Nothing may be added afterwards.
  void finish();

  // For the taker:
  /// Waits for the next batch. Nothing: finish() was called, and all batches were taken.
  std::optional<Batch> take();

  /// Number of dropped ticks. For the giver's thread; after finish(), for any thread.
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void hand_over();

  const std::size_t batch_ticks_, batches_;
  const WhenFull when_full_;
  Batch batch_;  // only the giver uses it
  std::uint64_t dropped_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> queue_;
  bool finished_ = false;
};

}  // namespace sandrunner
