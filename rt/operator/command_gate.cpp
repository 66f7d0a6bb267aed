// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/command_gate.h"

#include <cmath>

namespace sandrunner {

CommandVerdict CommandGate::judge(const Twist& twist, std::uint64_t publisher,
                                  std::int64_t now_ns) noexcept {
  // All six numbers, also those that a walking robot has no use for: who sends rubbish in one of
  // them is not to be believed in the others.
  bool finite = true, absurd = false;
  for (int i = 0; i < 3; ++i) {
    finite = finite && std::isfinite(twist.linear_mps[i]) && std::isfinite(twist.angular_radps[i]);
    absurd = absurd || std::fabs(twist.linear_mps[i]) > kAbsurdSpeed_mps ||
             std::fabs(twist.angular_radps[i]) > kAbsurdYawRate_radps;
  }
  if (!finite) return CommandVerdict::kNotFinite;
  if (absurd) return CommandVerdict::kAbsurd;
  if (publisher != holder_ && held(now_ns)) {
    return CommandVerdict::kOtherPublisher;
  }
  held_ = true;
  holder_ = publisher;
  last_ns_ = now_ns;
  return CommandVerdict::kAccepted;
}

}  // namespace sandrunner
