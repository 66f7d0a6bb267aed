// SPDX-License-Identifier: BSD-3-Clause
// A policy walks on hard ground in the simulator as it does in MuJoCo: the whole step of the robot,
// contacts and all, against an engine that is not ours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "estimator/observation.h"
#include "policy/policy_file.h"
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

/// Under a command of `vx_mps`. `state` and `step` are the engine's; a step is a control period.
Walk walk(Policy policy, double vx_mps, const std::function<RigidState<double>()>& state,
          const std::function<void(const std::array<double, kNumJoints>&)>& step) {
  constexpr int kTicks = 3 * kControlHz, kFrom = kControlHz;
  const PolicySpec& spec = policy.spec();
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
      torque_nm[j] =
          std::clamp(spec.kp_nmprad * (target_rad[j] - x.q[j]) - spec.kd_nmsprad * x.qd[j],
                     -spec.torque_limit_nm, spec.torque_limit_nm);
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

TEST(MujocoWalkTest, ShippedPolicyWalksAlikeInBothEngines) {
  const Policy policy = load_shipped_policy();
  for (const double vx_mps : {1.0, 2.0}) {
    SCOPED_TRACE(vx_mps);
    Bench bench;
    bench::MujocoRobot mujoco(bench.robot.model, kHardGround);
    mujoco.set(bench.state.rigid);
    const Walk theirs = walk(
        policy, vx_mps, [&] { return mujoco.state(); },
        [&](const auto& torque_nm) {
          mujoco.apply(torque_nm);
          mujoco.step();
        });
    const Walk ours = walk(
        policy, vx_mps, [&] { return bench.state.rigid; },
        [&](const auto& torque_nm) { bench.step(torque_nm); });
    EXPECT_NEAR(ours.speed_mps, theirs.speed_mps, 0.01 * vx_mps);
    EXPECT_NEAR(ours.height_m, theirs.height_m, 1e-3);
    EXPECT_NEAR(ours.square_torque, theirs.square_torque, 0.03 * theirs.square_torque);
  }
}

}  // namespace
}  // namespace sandrunner::sim
