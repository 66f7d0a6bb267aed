// SPDX-License-Identifier: BSD-3-Clause
// Your own robot behind RobotIo, in the loop that drives it, until its bus breaks.
#include <cstdio>

#include "rt/core/controller.h"
namespace sr = sandrunner;
struct MyRobot final : sr::RobotIo {
  // Begins a tick: fill in what has arrived, with the tick of each measurement.
  void read(std::uint64_t tick, sr::SensorFrame& frame) noexcept override {
    frame.imu.tick = tick;
    if (tick <= 8000) frame.joints.tick.fill(tick);  // after two seconds its bus is silent
  }
  // Ends a tick: send each drive its set-point, or switch it off.
  void write(const sr::SafeCommand& command) noexcept override { sent = command; }
  void cut_drives() noexcept override {}             // the loop hangs: switch off for good
  void shut_down() noexcept override { sent = {}; }  // the loop ends: switch off
  sr::SafeCommand sent;
};

int main() {
  sr::ControllerConfig config;
  config.damping.kd_nmsprad.fill(config.gate.kd_limit_nmsprad = 2.0);
  sr::Controller controller(config);
  sr::ControllerInput input;
  sr::ControllerOutput output;
  MyRobot robot;
  int ticks_on = 0;
  // Five seconds of ticks, 4,000 each. The robot is armed after one second.
  for (std::uint64_t tick = 1; tick <= 20000; ++tick) {
    if (tick == 4000) input.command = {{}, sr::ModeRequest::kArm, 1, tick};
    input.sensors.tick = tick;
    robot.read(tick, input.sensors);
    controller.step(input, output);
    robot.write(output.command);
    if (robot.sent.enabled()) ++ticks_on;
  }
  // The gate detects the silence after 9 ticks, damps for 2 s and switches the drives off.
  std::printf("%s; drives on for %d ticks\n", fault_name(output.first_fault), ticks_on);
  return output.first_fault == sr::Fault::kJointsStale && ticks_on == 4000 + 9 + 8000 ? 0 : 1;
}
