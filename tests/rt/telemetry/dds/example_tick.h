// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

#include "rt/core/safety_gate.h"
#include "rt/loop/tick_record.h"
#include "rt/telemetry/dds/telemetry.h"

namespace sandrunner {

inline constexpr std::int64_t kExampleStart_ns = 1'700'000'000'900'000'000;

/// A tick of a robot that walks along its x axis at 0.8 m/s, turned 90 degrees to the left; every
/// value another one. The joints' positions grow by 1e-6 rad a tick.
inline TickRecord example_tick(std::uint64_t tick) {
  TickRecord r{};
  SensorFrame& s = r.input.sensors;
  s.tick = s.imu.tick = tick;
  s.joints.tick.fill(tick);
  JointCommand wanted;
  for (int j = 0; j < kNumJoints; ++j) {
    s.joints.position_rad[j] = 0.1 * j + 1e-6 * static_cast<double>(tick);
    s.joints.velocity_radps[j] = 1.0 + j;
    s.joints.torque_nm[j] = -2.0 - j;
    wanted.position_rad[j] = -0.5 - 0.01 * j;
    wanted.kp_nmprad[j] = 50.0 + j;
    wanted.kd_nmsprad[j] = 0.5 + j;
  }
  s.imu.orientation_wxyz = {0.70710678118654752, 0.0, 0.0, 0.70710678118654752};
  s.imu.angular_velocity_radps = {0.1, 0.2, 0.3};
  s.imu.linear_acceleration_mps2 = {0.4, 0.5, 9.8};
  r.input.policy.sequence = 5;
  r.input.policy.episode = 1;
  r.input.policy.estimate = {.body_height_m = 0.45,
                             .velocity_mps = {0.8, 0.0, 0.01},
                             .foot_height_m = {0.01, 0.02, 0.03, 0.04}};
  GateState gate;
  r.output.command = SafetyGate(GateConfig{}, 2.0).pass(wanted, true, gate);
  r.output.mode = Mode::kWalk;
  r.output.policy_input.episode = 1;
  r.output.policy_input.command = {.vx_mps = 0.9, .vy_mps = -0.1, .wz_radps = 0.2};
  r.timing = {.late_ns = 2000, .read_ns = 3000, .control_ns = 4000, .write_ns = 5000};
  return r;
}

/// Publishes examples at the control loop's rate, from this tick on; returns the longest time that
/// one add() took, in s.
inline double publish_for(Telemetry& telemetry, std::uint64_t first_tick, double duration_s) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const std::uint64_t ticks = ticks_from_s(duration_s);
  double longest_s = 0.0;
  for (std::uint64_t done = 0; done < ticks;) {
    const std::chrono::duration<double> time = Clock::now() - start;
    for (const std::uint64_t due = std::min(ticks, ticks_from_s(time.count())); done < due;
         ++done) {
      const auto before = Clock::now();
      telemetry.add(example_tick(first_tick + done));
      longest_s = std::max(longest_s, std::chrono::duration<double>(Clock::now() - before).count());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return longest_s;
}

}  // namespace sandrunner
