// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/drive_core.h"

#include <algorithm>

namespace sandrunner::hil {

void DriveCore::command(const SetPoint& wanted, double most_nm, double wanted_timeout_s,
                        double now_s) noexcept {
  if (state == State::kOn) longest_gap_s = std::max(longest_gap_s, now_s - commanded_s);
  state = State::kOn;
  commanded = wanted;
  commanded_most_nm = std::min(most_nm, max_torque_nm);
  timeout_s = wanted_timeout_s;
  commanded_s = now_s;
}

void DriveCore::look_at_clock(double now_s) noexcept {
  if (faults.code != 0 && state == State::kOn) state = State::kFault;
  const bool can_time_out = state == State::kOn && timeout_s > 0.0 && !faults.untimed;
  if (!can_time_out || now_s - commanded_s <= timeout_s) return;
  ++time_outs;
  state = State::kTimedOut;
}

bool DriveCore::deliver() noexcept {
  ++answers;
  if (faults.lose_every > 0 && answers % static_cast<std::uint64_t>(faults.lose_every) == 0) {
    return false;
  }
  ++replies;
  return true;
}

}  // namespace sandrunner::hil
