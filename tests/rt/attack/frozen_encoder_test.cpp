// SPDX-License-Identifier: BSD-3-Clause
// One encoder that freezes while the robot rests in Stand, then a push: the robot stays on its feet
// or a fault about that joint stops it.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>

#include "attack_loop.h"

namespace sandrunner::attack {
namespace {

constexpr double kPush_mps = 0.8;

enum class Frozen { kNothing, kEncoder, kReplies };

/// Freezes joint `joint` for half a second, then pushes the robot.
Outcome pushed(const World& world, const Snapshot& at, Drives drives, Frozen frozen, int joint,
               double vx_mps, double vy_mps) {
  AttackLoop loop(world, drives, at);
  loop.run(0.1);
  const SensorFrame held = loop.record.input.sensors;
  if (frozen == Frozen::kEncoder) loop.robot.drive_is_misled = std::uint64_t{1} << joint;
  if (frozen != Frozen::kNothing) {
    loop.robot.spoil = [held, joint](SensorFrame& fresh, auto&&...) {
      fresh.joints.position_rad[joint] = held.joints.position_rad[joint];
      fresh.joints.velocity_radps[joint] = held.joints.velocity_radps[joint];
    };
  }
  loop.run(0.5);
  if (loop.fault() != Fault::kNone) return watch(loop, 3.0);
  loop.simulator.push(vx_mps, vy_mps);
  loop.loop.robot_changed();
  return watch(loop, 5.0);
}

struct PushTally {
  int runs = 0, stood = 0, fell = 0, fell_damped = 0;
  std::map<std::string, int> faults;
  double speed_radps = 0.0, latest_s = 0.0;

  void add(const Outcome& seen) {
    ++runs;
    speed_radps = std::max(speed_radps, seen.speed_radps);
    if (seen.fault != Fault::kNone) {
      ++faults[fault_name(seen.fault)];
      latest_s = std::max(latest_s, seen.after_s);
    }
    if (seen.fell()) ++fell;
    if (seen.fell() && degrees(seen.tilt_rad) < 45.0) ++fell_damped;
    if (!seen.fell() && seen.fault == Fault::kNone) ++stood;
  }
  void print(const std::string& name) const {
    std::printf("| %s | %d | %d | **%d** | %d | %.1f rad/s |", name.c_str(), runs, stood, fell,
                fell_damped, speed_radps);
    for (const auto& [fault, count] : faults) std::printf(" %s %d", fault.c_str(), count);
    std::printf(" (by %.2f s) |\n", latest_s);
    std::fflush(stdout);
  }
};

PushTally over_joints(const World& world, Drives drives, Frozen frozen) {
  const Snapshot at = standing(world, drives);
  PushTally tally;
  for (int joint = 0; joint < kNumJoints; ++joint) {
    for (const double push_mps : {-kPush_mps, kPush_mps}) {
      tally.add(pushed(world, at, drives, frozen, joint, push_mps, 0.0));
      tally.add(pushed(world, at, drives, frozen, joint, 0.0, push_mps));
    }
  }
  return tally;
}

TEST(FrozenEncoderTest, OneThatFreezesAtRestDoesNotToppleAPushedRobot) {
  const World world("raibo", "rigid");
  const Snapshot at = standing(world, Drives::kTorque);
  int control = 0, fell = 0;
  for (int joint = 0; joint < kNumJoints; ++joint) {
    const auto run = [&](Frozen frozen) {
      return pushed(world, at, Drives::kTorque, frozen, joint, 0.0, kPush_mps).fell() ? 1 : 0;
    };
    if (joint == 0) control += run(Frozen::kNothing);
    fell += run(Frozen::kEncoder);
  }
  EXPECT_EQ(control, 0);
  EXPECT_EQ(fell, 0) << "of 12 joints";
}

TEST(FrozenEncoderTest, CampaignOverJointsDirectionsAndDrives) {
  std::printf(
      "| runs | of | stand on | topple | of these after a fault | fastest joint | faults "
      "|\n|---|---|---|---|---|---|---|\n");
  for (const std::string robot : {"raibo", "go2"}) {
    for (const std::string terrain : {"rigid", "dry-sand"}) {
      if (!is_selected(robot + ", " + terrain)) continue;
      const World world(robot, terrain);
      const std::string where = robot + ", " + terrain + ", ";
      const PushTally control = over_joints(world, Drives::kTorque, Frozen::kNothing);
      control.print(where + "torque drives, control");
      const PushTally torque = over_joints(world, Drives::kTorque, Frozen::kEncoder);
      torque.print(where + "torque drives, one frozen");
      const PushTally gains_control = over_joints(world, Drives::kGains, Frozen::kNothing);
      gains_control.print(where + "gains, control");
      const PushTally gains = over_joints(world, Drives::kGains, Frozen::kEncoder);
      gains.print(where + "gains, one encoder frozen");
      const PushTally replies = over_joints(world, Drives::kGains, Frozen::kReplies);
      replies.print(where + "gains, the replies of one frozen");
      EXPECT_EQ(control.fell + gains_control.fell, 0) << where;
      // A small robot that is damped while it is pushed may roll over.
      for (const PushTally& tally : {torque, gains, replies}) {
        EXPECT_EQ(tally.fell, tally.fell_damped) << where;
      }
    }
  }
}

}  // namespace
}  // namespace sandrunner::attack
