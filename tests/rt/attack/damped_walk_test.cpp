// SPDX-License-Identifier: BSD-3-Clause
// None: a sound robot that is damped while it walks. Whether it rolls over depends on how much of
// the damping is in which joint.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "attack_loop.h"

namespace sandrunner::attack {
namespace {

struct DampedTally {
  int runs = 0, fell = 0, on_its_back = 0;
  double belly_mps = 0.0, torque_nm = 0.0;  ///< largest speed downward, largest torque of a joint
};

/// Damps at 24 moments of a walk at `velocity`.
void add_damped(const World& world, const VelocityCommand& velocity, DampedTally& tally) {
  AttackLoop walk(world, Drives::kGains, walking(world, Drives::kGains, velocity));
  for (int k = 0; k < 24; ++k) {
    walk.run(0.0275);
    AttackLoop loop(world, Drives::kGains, walk.snapshot());
    loop.command.velocity = velocity;
    loop.ask(ModeRequest::kDamp);
    DampedTally seen{.runs = 1};
    double tilt = 0.0;
    for (std::uint64_t n = ticks_from_s(2.0); n > 0; --n) {
      loop.step();
      const RobotTruth& truth = loop.truth();
      tilt = std::max(tilt, degrees(tilt_rad(truth)));
      seen.belly_mps = std::max(seen.belly_mps, -truth.velocity_mps[2]);
      for (const double nm : truth.joint_torque_nm) {
        seen.torque_nm = std::max(seen.torque_nm, std::fabs(nm));
      }
    }
    ++tally.runs;
    tally.fell += tilt > 60.0;
    tally.on_its_back += tilt > 90.0;
    tally.belly_mps = std::max(tally.belly_mps, seen.belly_mps);
    tally.torque_nm = std::max(tally.torque_nm, seen.torque_nm);
  }
}

TEST(DampedWalkTest, CampaignOverRobotsGroundsAndGains) {
  std::printf(
      "| robot, ground, damping of HAA, HFE, KFE | runs | tilted past 60 | on its back | fastest "
      "downward, m/s | of one that stood | torque, N m |\n|---|---|---|---|---|---|---|\n");
  for (const std::string robot : {"raibo", "go2"}) {
    for (const std::string terrain : {"rigid", "dry-sand"}) {
      if (!is_selected(robot + ", " + terrain)) continue;
      World world(robot, terrain);
      for (const LegJoints<double>& kd :
           {LegJoints<double>{2.0, 2.0, 2.0}, LegJoints<double>{4.0, 1.0, 0.5},
            LegJoints<double>{4.0, 0.5, 1.0}, LegJoints<double>{4.0, 0.5, 0.5},
            LegJoints<double>{5.0, 0.5, 0.5}, LegJoints<double>{2.0, 0.5, 0.5}}) {
        world.config.controller.damping.kd_nmsprad = kd;
        DampedTally walked, stood;
        for (const VelocityCommand& velocity :
             {VelocityCommand{.vx_mps = 1.0}, VelocityCommand{.vx_mps = 2.0},
              VelocityCommand{.vx_mps = 0.5, .wz_radps = 1.0}}) {
          add_damped(world, velocity, walked);
        }
        add_damped(world, {}, stood);
        std::printf("| %s, %s, %.1f, %.1f, %.1f | %d | %d | %d | %.2f | %.2f | %.0f |\n",
                    robot.c_str(), terrain.c_str(), kd[0], kd[1], kd[2], walked.runs, walked.fell,
                    walked.on_its_back, walked.belly_mps, stood.belly_mps, walked.torque_nm);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace sandrunner::attack
