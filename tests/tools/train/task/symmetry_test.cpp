// SPDX-License-Identifier: BSD-3-Clause
// The robot in the mirror is the robot: what the pull towards a symmetric policy rests on.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "estimator/observation.h"
#include "rt/core/processor.h"
#include "sim/batch/batch.h"
#include "sim/ground/terrain_description.h"
#include "tools/train/task/leg_modes.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

using learner::Reflection;

template <std::size_t kSize, typename T>
std::array<T, kSize> reflected(const Reflection& reflection, const std::array<T, kSize>& original) {
  std::array<T, kSize> image{};
  for (std::size_t i = 0; i < kSize; ++i) {
    image[i] = static_cast<T>(reflection.sign[i]) * original[reflection.index[i]];
  }
  return image;
}

// Mirror image of a state: left for right, y for -y; `haa`: sign of HAA in the mirror.
sim::RobotState<float> mirror_image(const sim::RobotState<float>& from, float haa) {
  const Reflection joints{{3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8},
                          {haa, 1, 1, haa, 1, 1, haa, 1, 1, haa, 1, 1}};
  sim::RobotState<float> to = from;
  sim::RigidState<float>& x = to.rigid;
  x.q = reflected(joints, from.rigid.q);
  x.qd = reflected(joints, from.rigid.qd);
  x.position.y = -x.position.y;
  x.velocity.y = -x.velocity.y;
  x.orientation.x = -x.orientation.x;
  x.orientation.z = -x.orientation.z;
  x.angular_velocity.x = -x.angular_velocity.x;
  x.angular_velocity.z = -x.angular_velocity.z;
  return to;
}

std::array<float, kObservationSize> observed(const InputScales& scales,
                                             const std::array<float, 3>& command,
                                             const sim::RigidState<float>& x) {
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  auto observation = make_observation<float>(
      command, {r.r2.x, r.r2.y, r.r2.z},
      {x.angular_velocity.x, x.angular_velocity.y, x.angular_velocity.z}, x.q, x.qd);
  for (int i = 0; i < kObservationSize; ++i) {
    observation[i] = normalised(scales, i, observation[i]);
  }
  return observation;
}

// The ground, and which way the HAA of the right legs turns.
class SymmetryTest : public testing::TestWithParam<std::tuple<sim::GroundKind, double>> {};

TEST_P(SymmetryTest, RobotInTheMirrorMovesLikeTheMirrorImage) {
  flush_denormals_to_zero();
  const auto [kind, right_haa] = GetParam();
  sim::Robot robot = sim::load_raibo();
  for (const int leg : {1, 3}) robot.model.legs[leg].sign[0] = right_haa;
  sim::TerrainDescription description;
  description.patches.resize(1);
  description.patches[0].ground.kind = kind;
  const sim::FootProfile<double> foot = sim::make_foot_profile(description, robot.model);
  sim::Batch batch(2, foot, sim::StepSettings{}, sim::BatchWidth::kOne);
  const auto terrain =
      sim::convert_terrain<float>(sim::make_terrain(description, foot, robot.model));
  const learner::Symmetry symmetry = Task::symmetry(robot);
  const InputScales scales = make_scales(robot.nominal_rad, 0.48, 6.0);

  sim::RobotState<float> state;
  std::array<sim::BatchDrive<float>, 2> drive;
  JointArray<float> answer;
  for (int j = 0; j < kNumJoints; ++j) {
    const auto wiggle = static_cast<float>(0.1 * std::sin(1.0 + 3.0 * j));
    state.rigid.q[j] = static_cast<float>(robot.nominal_rad[j]) + wiggle;
    state.rigid.qd[j] = 5.0f * wiggle;
    answer[j] = -wiggle;
  }
  state.rigid.position = {0.0f, 0.0f, static_cast<float>(robot.nominal_height_m)};
  state.rigid.orientation = sim::integrate(sim::Quaternion<float>{}, {0.05f, -0.03f, 0.2f});
  state.rigid.velocity = {0.5f, 0.3f, -0.2f};
  state.rigid.angular_velocity = {0.4f, -0.3f, 0.5f};
  drive[0].kp = 50.0f;
  drive[0].kd = 0.5f;
  drive[1] = drive[0];
  for (const int i : {0, 1}) {
    const auto modes = i == 0 ? answer : reflected(symmetry.action, answer);
    joints_from_modes({0.6, 0.7, 0.9, 1.6}, modes.data(), 1, drive[i].target.data());
    for (int j = 0; j < kNumJoints; ++j) {
      drive[i].target[j] += static_cast<float>(robot.nominal_rad[j]);
    }
    drive[i].target_before = drive[i].target;
  }
  for (int i = 0; i < 2; ++i) {
    batch.set_model(i, sim::convert_model<float>(robot.model));
    batch.set_terrain(i, terrain);
    batch.set_drive(i, drive[i]);
  }
  batch.set_state(0, state);
  batch.set_state(1, mirror_image(state, static_cast<float>(-right_haa)));
  float load = 0.0f;
  for (int step = 0; step < 20; ++step) {
    batch.advance(0, kTicksPerPolicyStep);
    batch.advance(1, kTicksPerPolicyStep);
    const auto original = observed(scales, {1.0f, 0.2f, -0.3f}, batch.state(0).rigid);
    const auto mirrored = observed(scales, {1.0f, -0.2f, 0.3f}, batch.state(1).rigid);
    const auto expected = reflected(symmetry.observation, original);
    for (int i = 0; i < kObservationSize; ++i) {
      // The published inertias differ a little between left and right.
      EXPECT_NEAR(mirrored[i], expected[i], 0.05) << "element " << i << " step " << step;
    }
    for (const float n : batch.sums(0).foot_load) load += n;
  }
  EXPECT_GT(load, 0.0f);
}

INSTANTIATE_TEST_SUITE_P(Grounds, SymmetryTest,
                         testing::Combine(testing::Values(sim::GroundKind::kGranular,
                                                          sim::GroundKind::kRigid),
                                          testing::Values(1.0, -1.0)));

TEST(SymmetryShapeTest, ReflectionsAreTheirOwnInverse) {
  const learner::Symmetry s = Task::symmetry(sim::load_raibo());
  EXPECT_EQ(s.observation.index.size(), std::size_t{kObservationSize});
  EXPECT_EQ(s.action.index.size(), std::size_t{kNumJoints});
  EXPECT_EQ(s.insight.index.size(), std::size_t{kInsightSize});
  for (const Reflection& r : {s.observation, s.action, s.insight}) {
    for (std::size_t i = 0; i < r.index.size(); ++i) {
      EXPECT_EQ(r.index[r.index[i]], static_cast<int>(i));
      EXPECT_EQ(r.sign[i] * r.sign[r.index[i]], 1.0f);
    }
  }
}

}  // namespace
}  // namespace sandrunner::train
