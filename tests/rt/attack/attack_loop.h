// SPDX-License-Identifier: BSD-3-Clause
// The whole robot in one thread on a ground, as all attacks begin. Example:
// drifting_attitude_test.cpp.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/rt/loop/disturbed_loop.h"
#include "tests/rt/loop/watch.h"

namespace sandrunner::attack {

/// A robot, its policy and the ground that it is on.
struct World {
  explicit World(const std::string& robot, const std::string& terrain,
                 std::vector<std::string> settings = {})
      : policy(load_shipped_policy(robot)) {
    settings.push_back("robot=" + robot);
    config = config_of(terrain, settings, &policy.spec());
  }
  Policy policy;
  ProcessConfig config;
};

class AttackLoop : public DisturbedLoop {
 public:
  /// The robot lies, passive.
  AttackLoop(const World& world, Drives drives)
      : DisturbedLoop(world.config, world.policy, drives) {
    command.velocity = {};
  }
  AttackLoop(const World& world, Drives drives, const Snapshot& at)
      : DisturbedLoop(world.config, world.policy, drives, at) {
    command.velocity = {};
  }

  /// From lying to Stand.
  void stand_up() {
    run(0.1);
    ask(ModeRequest::kArm);
    run(0.1);
    ask(ModeRequest::kStand);
    run(4.0);
  }
  void walk(const VelocityCommand& velocity, double duration_s) {
    command.velocity = velocity;
    ask(ModeRequest::kWalk);
    run(duration_s);
  }
};

/// The robot in Stand, or walking at `velocity` for 4 s.
inline Snapshot standing(const World& world, Drives drives) {
  AttackLoop loop(world, drives);
  loop.stand_up();
  EXPECT_EQ(loop.mode(), Mode::kStand);
  return loop.snapshot();
}
inline Snapshot walking(const World& world, Drives drives, const VelocityCommand& velocity,
                        double duration_s = 4.0) {
  AttackLoop loop(world, drives, standing(world, drives));
  loop.walk(velocity, duration_s);
  EXPECT_EQ(loop.mode(), Mode::kWalk);
  return loop.snapshot();
}

/// Whether a campaign is to run the row `name`: all, or those that contain SANDRUNNER_ATTACK_ONLY.
inline bool is_selected(const std::string& name) {
  const char* const only = std::getenv("SANDRUNNER_ATTACK_ONLY");
  return only == nullptr || name.find(only) != std::string::npos;
}

}  // namespace sandrunner::attack
