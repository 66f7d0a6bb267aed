// SPDX-License-Identifier: BSD-3-Clause
// The controller and its safety gate, stepped by hand: no clock, no thread, no robot.
#include <cmath>
#include <cstdio>

#include "rt/core/controller.h"
namespace sr = sandrunner;

int main() {
  // What the controller must know of the robot; `sandrunner` reads it from the robot file.
  sr::ControllerConfig config;
  config.damping.kd_nmsprad = {2.0, 2.0, 2.0};  // HAA, HFE, KFE
  config.gate.kd_limit_nmsprad = 5.0;
  sr::Controller controller(config);
  sr::ControllerInput input;
  sr::ControllerOutput output;

  // One tick, 0.25 ms: sensor values come in, a command for the drives goes out.
  const auto tick = [&] {
    input.sensors.joints.tick.fill(++input.sensors.tick);
    input.sensors.imu.tick = input.sensors.tick;
    controller.step(input, output);
    std::printf("%-8s drives %-4s kd %.1f N m s/rad, fault %s\n", mode_name(output.mode),
                output.command.enabled() ? "on," : "off,", output.command.joints().kd_nmsprad[0],
                fault_name(output.first_fault));
    return output.mode;
  };
  bool well = tick() == sr::Mode::kPassive && !output.command.enabled();

  // An operator arms the robot: its drives are on, and brake.
  input.command = {{}, sr::ModeRequest::kArm, 1, 0};
  well = well && tick() == sr::Mode::kDamping && output.command.joints().kd_nmsprad[0] == 2.0;

  // An encoder fails. The gate detects it in the same tick and gives this joint no torque.
  input.sensors.joints.position_rad[5] = NAN;
  well = well && tick() == sr::Mode::kFault && output.command.blind_joints() == 1U << 5U;
  return well ? 0 : 1;
}
