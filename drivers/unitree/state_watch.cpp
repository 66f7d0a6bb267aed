// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/state_watch.h"

#include <algorithm>

namespace sandrunner::unitree {

bool StateWatch::take(const LowState& message, std::int64_t now_ns) noexcept {
  const Crc crc = judge_crc(message);
  if (crc == Crc::kBad) {
    ++counters_.bad_crc;
    return false;
  }
  RobotState state;
  if (!decode(message, state)) {
    ++counters_.not_finite;
    return false;
  }
  if (counters_.taken > 0) {
    // The counter wraps after 49 days.
    const auto ticks = static_cast<std::int32_t>(state.tick_ms - state_.tick_ms);
    if (ticks <= 0) {
      ++(ticks == 0 ? counters_.repeated : counters_.old);
      return false;
    }
    device_ns_ += static_cast<std::uint64_t>(ticks) * static_cast<std::uint64_t>(tick_ns_);
  }
  state_ = state;
  sampled_ns_ = clock_.update(device_ns_, now_ns);
  if (counted_ == 0) {
    first_ns_ = now_ns;
    first_tick_ = state.tick_ms;
  } else {
    longest_gap_ns_ = std::max(longest_gap_ns_, now_ns - received_ns_);
  }
  ++counted_;
  received_ns_ = now_ns;
  ++counters_.taken;
  if (crc == Crc::kAbsent) ++counters_.without_crc;
  return true;
}

void StateWatch::begin_figures() noexcept {
  counted_ = 0;
  longest_gap_ns_ = 0;
}

double StateWatch::rate_hz() const noexcept {
  if (counted_ < 2 || received_ns_ <= first_ns_) return 0.0;
  return 1e9 * static_cast<double>(counted_ - 1) / static_cast<double>(received_ns_ - first_ns_);
}

double StateWatch::tick_rate_hz() const noexcept {
  if (counted_ < 2 || received_ns_ <= first_ns_) return 0.0;
  const auto ticks = static_cast<double>(state_.tick_ms - first_tick_);
  return 1e9 * ticks / static_cast<double>(received_ns_ - first_ns_);
}

}  // namespace sandrunner::unitree
