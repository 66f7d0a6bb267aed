// SPDX-License-Identifier: BSD-3-Clause
// A policy walks on hard ground in the simulator as it does in MuJoCo: the whole step of the robot,
// contacts and all, against an engine that is not ours.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "estimator/observation.h"
#include "policy/policy_file.h"
#include "sim/step/actuator.h"
#include "tests/sim/support.h"
#include "tools/bench/mujoco/mujoco_robot.h"

namespace sandrunner::sim {
namespace {

// Contacts stiff enough to yield a tenth of a millimetre, overdamped.
const bench::MujocoSettings kHardGround{.option = "cone='elliptic'",
                                        .contact = "friction='0.8' condim='3' solref='0.002 1'"};

struct Walk {
  double speed_mps = 0.0;      ///< over ground, of the last 2 of 3 s
  double height_m = 0.0;       ///< of the base, mean over the same time
  double square_torque = 0.0;  ///< sum over the joints of tau^2, mean, N^2 m^2
};

/// Under a command of `vx_mps`, with the drives of `robot`. `state` and `step` are the engine's; a
/// step is a control period.
Walk walk(Policy policy, const Robot& robot, double vx_mps,
          const std::function<RigidState<double>()>& state,
          const std::function<void(const std::array<double, kNumJoints>&)>& step) {
  constexpr int kTicks = 3 * kControlHz, kFrom = kControlHz;
  const PolicySpec& spec = policy.spec();
  DriveLine<double> line;
  if (robot.obeys_torque_speed_line) line = drive_line<double>(robot.torque_speed_line);
  JointArray<double> target_rad{}, next_rad{};
  Walk result;
  Vec3<double> start;
  for (int tick = 0; tick < kTicks; ++tick) {
    const RigidState<double> x = state();
    const Quaternion<double>& o = x.orientation;
    target_rad = next_rad;  // an answer is used a tick after its question
    if (tick % kTicksPerPolicyStep == 0) {
      const auto observation = make_observation<double>(
          {vx_mps, 0.0, 0.0}, up_in_body({o.w, o.x, o.y, o.z}),
          {x.angular_velocity.x, x.angular_velocity.y, x.angular_velocity.z}, x.q, x.qd);
      std::array<float, kObservationSize> raw;
      std::copy(observation.begin(), observation.end(), raw.begin());
      next_rad = policy.step(raw).target_rad;
      if (tick == 0) target_rad = next_rad;
    }
    std::array<double, kNumJoints> torque_nm;
    double square = 0.0;
    for (int j = 0; j < kNumJoints; ++j) {
      torque_nm[j] = drive_torque<double>(
          j, x.q[j], x.qd[j], {.q = target_rad[j], .kp = spec.kp_nmprad, .kd = spec.kd_nmsprad},
          std::min(robot.model.torque_limit_nm[j], spec.torque_limit_nm), line);
      square += torque_nm[j] * torque_nm[j];
    }
    step(torque_nm);
    if (tick < kFrom) continue;
    if (tick == kFrom) start = x.position;
    result.height_m += x.position.z / (kTicks - kFrom);
    result.square_torque += square / (kTicks - kFrom);
  }
  const Vec3<double> end = state().position;
  result.speed_mps = std::hypot(end.x - start.x, end.y - start.y) * kControlHz / (kTicks - kFrom);
  return result;
}

Walk walk_in_mujoco(const Policy& policy, const Robot& robot, double vx_mps) {
  const Bench bench(ground_of_kind(GroundKind::kRigid), robot);
  bench::MujocoRobot mujoco(robot.model, kHardGround);
  mujoco.set(bench.state.rigid);
  return walk(
      policy, robot, vx_mps, [&] { return mujoco.state(); },
      [&](const auto& torque_nm) {
        mujoco.apply(torque_nm);
        mujoco.step();
      });
}

Walk walk_in_ours(const Policy& policy, const Robot& robot, double vx_mps) {
  Bench bench(ground_of_kind(GroundKind::kRigid), robot);
  return walk(
      policy, robot, vx_mps, [&] { return bench.state.rigid; },
      [&](const auto& torque_nm) { bench.step(torque_nm); });
}

TEST(MujocoWalkTest, ShippedPolicyWalksAlikeInBothEngines) {
  const Policy policy = load_shipped_policy();
  const Robot robot = load_raibo();
  for (const double vx_mps : {1.0, 2.0}) {
    SCOPED_TRACE(vx_mps);
    const Walk theirs = walk_in_mujoco(policy, robot, vx_mps);
    const Walk ours = walk_in_ours(policy, robot, vx_mps);
    EXPECT_NEAR(ours.speed_mps, theirs.speed_mps, 0.01 * vx_mps);
    EXPECT_NEAR(ours.height_m, theirs.height_m, 1e-3);
    EXPECT_NEAR(ours.square_torque, theirs.square_torque, 0.03 * theirs.square_torque);
  }
}

/// Go2 as other models of it have it (sim/robot/README.md): heavier calves, one rotor inertia for
/// all joints, the knees of Go1.
Robot go2_as(bool heavy_calves, bool one_rotor, bool knees_of_go1) {
  Robot robot = load_robot("go2");
  RobotModel<double>& m = robot.model;
  for (int l = 0; l < kNumLegs; ++l) {
    const int knee = kJointsPerLeg * l + 2;
    if (heavy_calves) {
      Body<double>& calf = m.legs[l].shank;
      const double factor = 1.0 + 0.0468 / calf.mass;
      calf.mass *= factor;
      for (double* i : {&calf.inertia.xx, &calf.inertia.xy, &calf.inertia.xz, &calf.inertia.yy,
                        &calf.inertia.yz, &calf.inertia.zz}) {
        *i *= factor;
      }
    }
    if (knees_of_go1) {
      m.torque_limit_nm[knee] = 35.55;
      m.speed_limit_radps[knee] = 20.07;
    }
  }
  if (one_rotor) m.rotor_inertia.fill(0.01);
  if (knees_of_go1) {  // the hip's drive behind a gear of 1.5
    TorqueSpeedLine& line = robot.torque_speed_line;
    line.stall_torque_nm[2] = 1.5 * line.stall_torque_nm[0];
    line.no_load_speed_radps[2] = line.no_load_speed_radps[0] / 1.5;
  }
  return robot;
}

TEST(MujocoWalkTest, Go2WalksInMujocoAsInOursWhicheverModelOfItIsRight) {
  const Policy policy = load_shipped_policy("go2");
  for (const double vx_mps : {1.0, 2.0}) {
    const Walk ours = walk_in_ours(policy, load_robot("go2"), vx_mps);
    for (int model = 0; model < 8; ++model) {
      const Robot robot = go2_as((model & 1) != 0, (model & 2) != 0, (model & 4) != 0);
      SCOPED_TRACE(fmt::format("{} m/s, model {}", vx_mps, model));
      const Walk theirs = walk_in_mujoco(policy, robot, vx_mps);
      EXPECT_NEAR(theirs.speed_mps, ours.speed_mps, 0.05 * vx_mps);
      EXPECT_NEAR(theirs.height_m, ours.height_m, 0.02);
    }
  }
}

}  // namespace
}  // namespace sandrunner::sim
