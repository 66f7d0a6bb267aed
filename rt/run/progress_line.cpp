// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/progress_line.h"

#include <fmt/format.h>

#include <string>

#include "rt/base/standard_error.h"
#include "rt/core/mode_machine.h"
#include "rt/report/body_motion.h"

namespace sandrunner {

void ProgressLine::add(const TickRecord& tick) {
  if (!rate_.due(tick.input.sensors.tick)) return;
  const RobotTruth& truth = tick.truth;
  const double speed_mps =
      body_motion(truth.orientation_wxyz, truth.velocity_mps, truth.angular_velocity_radps).vx_mps;
  const std::string where =
      tick.has_truth != 0 ? fmt::format("{:6.2f} m/s  x {:7.2f} m ", speed_mps, truth.position_m[0])
                          : "";
  to_standard_error(fmt::format("\r{:8.1f} s  {:<9} {}",
                                static_cast<double>(tick.input.sensors.tick) * kControlPeriod_s,
                                mode_name(tick.output.mode), where),
                    0);
}

void ProgressLine::end() { to_standard_error(fmt::format("\r{:60}\r", "")); }

}  // namespace sandrunner
