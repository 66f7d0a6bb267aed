// SPDX-License-Identifier: BSD-3-Clause
// Task: what policy, estimator and critic are shown, and how it looks in a mirror.
#include <algorithm>
#include <cmath>

#include "estimator/observation.h"
#include "sim/step/ground_truth.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {

std::array<float, kEstimateSize> Task::truth(const Env& e,
                                             const sim::RobotState<float>& state) const {
  const StateEstimate t = sim::ground_truth(robot_.model, state, e.terrain);
  std::array<float, kEstimateSize> out;
  out[0] = static_cast<float>(t.body_height_m);
  for (int i = 0; i < 3; ++i) out[1 + i] = static_cast<float>(t.velocity_mps[i]);
  for (int l = 0; l < kNumLegs; ++l) out[4 + l] = static_cast<float>(t.foot_height_m[l]);
  return out;
}

// Of the patch under the base.
const TerrainFeatures& Task::features_under(const Env& e,
                                            const sim::RobotState<float>& state) const {
  return e.ground_features[static_cast<std::size_t>(e.terrain.region_at(state.rigid.position.x))];
}

void Task::privileged(const Env& e, const sim::RobotState<float>& state,
                      const sim::BatchReport<float>& report, float* out) const {
  const sim::SensorReading exact = sim::read_sensors(state.rigid, {});
  const auto clean = make_observation<float>(e.command, exact.up, exact.angular_velocity,
                                             exact.position, exact.velocity);
  for (int i = 0; i < kObservationSize; ++i) *out++ = normalised(scales_, i, clean[i]);
  const auto estimate = truth(e, state);
  for (int i = 0; i < kEstimateSize; ++i) {
    *out++ = std::clamp((estimate[i] - scales_.estimate_mean[i]) / scales_.estimate_deviation[i],
                        -6.0f, 6.0f);
  }
  for (int l = 0; l < kNumLegs; ++l) {
    *out++ = e.unloaded_steps[l] < kUnloadedSteps ? 1.0f : 0.0f;
    *out++ = std::min(4.0f * e.air_s[l], 3.0f);
    *out++ = std::min(4.0f * e.stance_s[l], 3.0f);
    *out++ = std::clamp(20.0f * report.penetration[l], -3.0f, 3.0f);
  }
  for (int j = 0; j < kNumJoints; ++j) *out++ = 0.5f * e.action[j];
  const TerrainFeatures& ground = features_under(e, state);
  for (int i = 0; i < kGroundFeatures; ++i) *out++ = ground[i];
  for (float f : e.robot_features) *out++ = f;
}

// What sensors that err show the policy, normalised.
void Task::policy_input(int env, Env& e, const sim::RobotState<float>& state, float* out) const {
  sim::SensorReading seen = sim::read_sensors(state.rigid, e.sensors);
  sim::add_noise(seen, config_.noise, [&](int, double sigma) {
    return e.noise_level * static_cast<float>(sigma * normal(env, e));
  });
  const auto raw = make_observation<float>(e.command, seen.up, seen.angular_velocity, seen.position,
                                           seen.velocity);
  for (int i = 0; i < kObservationSize; ++i) out[i] = normalised(scales_, i, raw[i]);
}

void Task::observe_env(int env, int t, learner::Rollout& rollout) {
  Env& e = envs_[static_cast<std::size_t>(env)];
  const sim::RobotState<float> state = batch_.state(env);
  const sim::BatchReport<float> report = batch_.report(env);
  policy_input(env, e, state, rollout.observation(t).col(env).data());
  privileged(e, state, report, rollout.privileged(t).col(env).data());
  const auto estimate = truth(e, state);
  auto target = rollout.estimate_target(t).col(env);
  for (int i = 0; i < kEstimateSize; ++i) {
    target[i] = std::clamp((estimate[i] - scales_.estimate_mean[i]) / scales_.estimate_deviation[i],
                           -6.0f, 6.0f);
  }
  if (rollout.shape.insight == 0) return;
  float* insight = rollout.insight(t).col(env).data();
  insight = std::ranges::copy(features_under(e, state), insight).out;
  insight = std::copy(target.begin(), target.end(), insight);
  for (const std::int32_t steps : e.unloaded_steps)
    *insight++ = steps < kUnloadedSteps ? 1.0f : 0.0f;
}

void Task::observe(int block, int t, learner::Rollout& rollout) {
  for (int i = 0; i < block_envs_; ++i) observe_env(block * block_envs_ + i, t, rollout);
}

learner::Symmetry Task::symmetry(const sim::Robot& robot) {
  // The HAA of a robot whose left and right axes are opposite has the same angle in the mirror.
  const auto haa = static_cast<float>(-robot.model.legs[0].sign[0] * robot.model.legs[1].sign[0]);
  learner::Symmetry s;
  const auto add = [](learner::Reflection& to, std::initializer_list<float> signs) {
    for (const float sign : signs) {
      to.index.push_back(static_cast<int>(to.index.size()));
      to.sign.push_back(sign);
    }
  };
  // A group of values of each leg: those of the leg on the other side.
  const auto add_legs = [](learner::Reflection& to, std::initializer_list<float> signs) {
    const auto first = static_cast<int>(to.index.size()), width = static_cast<int>(signs.size());
    for (const int other : {1, 0, 3, 2}) {
      int i = 0;
      for (const float sign : signs) {
        to.index.push_back(first + other * width + i++);
        to.sign.push_back(sign);
      }
    }
  };
  add(s.observation, {1, -1, -1});       // command vx, vy, wz
  add(s.observation, {1, -1, 1});        // gravity
  add(s.observation, {-1, 1, -1});       // angular velocity
  add_legs(s.observation, {haa, 1, 1});  // joint positions less nominal, and velocities
  add_legs(s.observation, {haa, 1, 1});
  for (int i = 0; i < kTerrainSize; ++i) add(s.insight, {1});
  add(s.insight, {1, 1, -1, 1});  // body height, velocity
  add_legs(s.insight, {1});       // foot heights
  add_legs(s.insight, {1});       // loaded feet
  // Modes of the legs: pronk and bound are their own images, pace and trot begin with the other
  // side.
  for (const float side : {1.0f, 1.0f, -1.0f, -1.0f}) add(s.action, {haa * side, side, side});
  return s;
}

}  // namespace sandrunner::train
