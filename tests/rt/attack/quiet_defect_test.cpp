// SPDX-License-Identifier: BSD-3-Clause
// Defects that the robot lives with for a while: held joints, drives without torque or with the
// wrong sign, stuck encoders, legs in the air. Torques, speeds and the time to a fault.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <string>

#include "outcome.h"

namespace sandrunner::attack {
namespace {

using Acts = std::function<void(AttackLoop&)>;

Outcome with_defect(const World& world, Drives drives, const Snapshot& at, double duration_s,
                    const Acts& acts, double vx_mps) {
  AttackLoop loop(world, drives, at);
  loop.command.velocity.vx_mps = vx_mps;
  loop.run(0.05);
  if (acts) acts(loop);
  return watch(loop, duration_s);
}

Acts limp(std::uint64_t joints) {
  return [joints](AttackLoop& loop) { loop.robot.limp = joints; };
}
/// Stuck but for a count of the encoder, where it is now.
Acts stuck(int joint) {
  return [joint](AttackLoop& loop) {
    const double at_rad = loop.record.input.sensors.joints.position_rad[joint];
    loop.robot.drive_is_misled = std::uint64_t{1} << joint;
    loop.robot.spoil = [=](SensorFrame& fresh, const SensorFrame&, std::uint64_t n) {
      fresh.joints.position_rad[joint] = at_rad + (n / 7 % 2 == 0 ? 0.0 : 0.0004);
      fresh.joints.velocity_radps[joint] = n % 2 == 0 ? 0.01 : -0.01;
    };
  };
}
/// The speed alone.
Acts speed_stuck(int joint) {
  return [joint](AttackLoop& loop) {
    loop.robot.spoil = [=](SensorFrame& fresh, const SensorFrame&, std::uint64_t n) {
      fresh.joints.velocity_radps[joint] = n % 2 == 0 ? 0.01 : -0.01;
    };
  };
}
Acts frozen(int joint) {
  return [joint](AttackLoop& loop) {
    const JointState held = loop.record.input.sensors.joints;
    loop.robot.drive_is_misled = std::uint64_t{1} << joint;
    loop.robot.spoil = [=](SensorFrame& fresh, auto&&...) {
      fresh.joints.position_rad[joint] = held.position_rad[joint];
      fresh.joints.velocity_radps[joint] = held.velocity_radps[joint];
    };
  };
}

/// Arms a lying robot whose drive `joint` gives its torque in the wrong direction, and stands up.
Outcome armed_inverted(const World& world, int joint) {
  AttackLoop loop(world, Drives::kGains);
  if (joint >= 0) loop.robot.inverted = std::uint64_t{1} << joint;
  loop.run(0.1);
  loop.ask(ModeRequest::kArm);
  loop.run(0.1);
  loop.ask(ModeRequest::kStand);
  return watch(loop, 5.0);
}

TEST(QuietDefectTest, CampaignOverDefects) {
  print_outcomes_header();
  constexpr std::uint64_t kAllHaa = 0b001001001001;
  for (const std::string robot : {"raibo", "go2"}) {
    if (!is_selected(robot)) continue;
    const World world(robot, "rigid");
    const Drives gains = Drives::kGains;
    const Snapshot walk = walking(world, gains, {.vx_mps = 1.0});
    const Snapshot stand = standing(world, gains);
    const auto row = [&](const char* name, const Snapshot& at, double duration_s, const Acts& acts,
                         double vx_mps = 1.0) {
      print_outcome(robot + ", " + name, with_defect(world, gains, at, duration_s, acts, vx_mps));
    };
    row("Walk, control", walk, 10.0, nullptr);
    row("Walk, HAA held", walk, 10.0, [](AttackLoop& loop) { hold(loop, 1u << 0); });
    row("Walk, HFE held", walk, 10.0, [](AttackLoop& loop) { hold(loop, 1u << 1); });
    row("Walk, KFE held", walk, 10.0, [](AttackLoop& loop) { hold(loop, 1u << 2); });
    row("Walk, lifted", walk, 9.0, lift);
    row("Walk, four HAA limp", walk, 5.0, limp(kAllHaa));
    for (const double vx_mps : {0.0, 0.5}) {
      const Snapshot slow = walking(world, gains, {.vx_mps = vx_mps});
      row(vx_mps == 0.0 ? "Walk on the spot, four HAA limp" : "Walk at 0.5 m/s, four HAA limp",
          slow, 5.0, limp(kAllHaa), vx_mps);
    }
    row("Walk, one HAA limp", walk, 5.0, limp(1u << 0));
    row("Walk, HAA stuck but for a count", walk, 5.0, stuck(0));
    row("Walk, HFE stuck but for a count", walk, 5.0, stuck(1));
    row("Walk, KFE stuck but for a count", walk, 5.0, stuck(2));
    row("Walk, HAA speed stuck", walk, 5.0, speed_stuck(0));
    row("Walk, HFE speed stuck", walk, 5.0, speed_stuck(1));
    row("Walk, KFE speed stuck", walk, 5.0, speed_stuck(2));
    row("Stand, control", stand, 10.0, nullptr);
    for (int joint = 0; joint < kJointsPerLeg; ++joint) {
      const std::string name = std::array{"HAA", "HFE", "KFE"}[joint];
      row(("Stand, " + name + " limp").c_str(), stand, 10.0, limp(std::uint64_t{1} << joint));
      row(("Stand, " + name + " frozen at rest").c_str(), stand, 10.0, frozen(joint));
      print_outcome(robot + ", armed, " + name + " reversed", armed_inverted(world, joint));
    }
    print_outcome(robot + ", armed, control", armed_inverted(world, -1));
  }
}

}  // namespace
}  // namespace sandrunner::attack
