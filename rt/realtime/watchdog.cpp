// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/watchdog.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kLook_ns = 5'000'000;
// A look later than this was held up itself: so, most likely, was the control thread.
constexpr std::int64_t kHeldUp_ns = 4 * kLook_ns;

}  // namespace

void Watchdog::run(std::int64_t start_ns) noexcept {
  for (std::int64_t at_ns = start_ns; !stop_.load(std::memory_order_relaxed);
       at_ns = clock_.now_ns() + kLook_ns) {
    clock_.sleep_until(at_ns);
    look(clock_.now_ns());
  }
}

void Watchdog::look(std::int64_t now_ns) noexcept {
  const std::uint64_t ticks = ticks_.load(std::memory_order_relaxed);
  const std::int64_t gap_ns = watching_ ? now_ns - looked_ns_ : 0;
  const bool held_up = gap_ns > kHeldUp_ns;
  if (gap_ns > longest_gap_ns()) longest_gap_ns_.store(gap_ns, std::memory_order_relaxed);
  if (!watching_ || ticks != seen_ || held_up) alive_ns_ = now_ns;
  watching_ = true;
  seen_ = ticks;
  looked_ns_ = now_ns;
  if (now_ns - alive_ns_ < kWatchdog_ns) return;
  robot_.cut_drives();
  cut_.store(true, std::memory_order_relaxed);
}

}  // namespace sandrunner
