// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

namespace sandrunner {

/// The grid of a periodic thread: slot n is due at start + n periods, for ever. A thread that is
/// late by less than a period runs at once. A later one skips whole slots, so that a stall is a
/// counted miss and not a burst of steps. The grid knows no clock: times are given to it.
class SlotGrid {
 public:
  SlotGrid(std::int64_t start_ns, std::int64_t period_ns) noexcept
      : start_ns_(start_ns), period_ns_(period_ns) {}

  /// When the next slot is due.
  std::int64_t due_ns() const noexcept {
    return start_ns_ + static_cast<std::int64_t>(next_) * period_ns_;
  }

  /// One slot that runs.
  struct Slot {
    std::uint64_t number = 0;
    std::uint64_t skipped = 0;  ///< slots missed directly before it
    std::int64_t late_ns = 0;   ///< since it was due, below a period
  };

  /// Takes the slot that runs at `now_ns` (not before due_ns()).
  Slot take(std::int64_t now_ns) noexcept {
    const std::int64_t late = std::max<std::int64_t>(now_ns - due_ns(), 0);
    const auto skipped = static_cast<std::uint64_t>(late / period_ns_);
    const Slot slot{next_ + skipped, skipped, late % period_ns_};
    next_ = slot.number + 1;
    return slot;
  }

 private:
  std::int64_t start_ns_, period_ns_;
  std::uint64_t next_ = 0;
};

}  // namespace sandrunner
