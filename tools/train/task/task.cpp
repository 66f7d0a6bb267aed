// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/task.h"

#include <algorithm>
#include <cmath>

#include "estimator/observation.h"
#include "rt/core/command_shaping.h"
#include "sim/ground/terrain_description.h"
#include "sim/step/divergence.h"
#include "sim/step/ground_truth.h"

namespace sandrunner::train {
namespace {

constexpr float kStep_s = 1.0f / kPolicyHz;
// A foot is loaded when it carried more than this in the last two policy steps: on sand the normal
// force comes in pulses.
constexpr float kLoaded_n = 3.0f;
constexpr int kUnloadedSteps = 2;

sim::StepSettings batch_settings() {
  sim::StepSettings s;
  s.max_sweeps =
      40;  // a tumbling robot's contact problem need not be solved to the end: its episode is over
  return s;
}

}  // namespace

Task::Task(const TrainConfig& config, const sim::Robot& robot, std::uint64_t seed)
    : config_(config),
      seed_(seed),
      block_envs_(config.learner.block_envs),
      robot_(robot),
      scales_(make_scales(robot_.nominal_rad, config.policy.body_height_m,
                          config.policy.observation_clip)),
      foot_(sim::make_foot_profile({}, robot_.model)),
      batch_(config.run.envs, foot_, batch_settings()),
      envs_(static_cast<std::size_t>(config.run.envs)),
      sums_(static_cast<std::size_t>(config.run.envs / config.learner.block_envs)),
      curriculum_{config.command.speed_start_mps, 0.0},
      cost_ramp_{.all = config.reward.cost_ramp_start},
      tilt_end_cos_(std::cos(config.episode.tilt_end_deg * 3.14159265358979 / 180.0)) {
  for (int env = 0; env < config.run.envs; ++env) {
    Env& e = envs_[static_cast<std::size_t>(env)];
    hard_reset(env, e);
    // Episodes out of step with each other.
    e.step = static_cast<std::int32_t>(uniform(env, e) * config.episode.length_s * kPolicyHz);
  }
}

std::array<float, kEstimateSize> Task::truth(const Env& e,
                                             const sim::RobotState<float>& state) const {
  const StateEstimate t = sim::ground_truth(robot_.model, state, e.terrain);
  std::array<float, kEstimateSize> out;
  out[0] = static_cast<float>(t.body_height_m);
  for (int i = 0; i < 3; ++i) out[1 + i] = static_cast<float>(t.velocity_mps[i]);
  for (int l = 0; l < kNumLegs; ++l) out[4 + l] = static_cast<float>(t.foot_height_m[l]);
  return out;
}

void Task::privileged(int, const Env& e, const sim::RobotState<float>& state,
                      const sim::BatchReport<float>& report, float* out) const {
  const sim::RigidState<float>& x = state.rigid;
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  const auto clean = make_observation<float>(
      e.command, {r.r2.x, r.r2.y, r.r2.z},
      {x.angular_velocity.x, x.angular_velocity.y, x.angular_velocity.z}, x.q, x.qd);
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
  for (int j = 0; j < kNumJoints; ++j) *out++ = 0.5f * e.action_1[j];
  const auto patch = static_cast<std::size_t>(e.terrain.region_at(x.position.x));
  for (float f : e.ground_features[patch]) *out++ = f;
  for (float f : e.robot_features) *out++ = f;
}

void Task::observe_env(int env, int t, learner::Rollout& rollout) {
  Env& e = envs_[static_cast<std::size_t>(env)];
  const sim::RobotState<float> state = batch_.state(env);
  const sim::BatchReport<float> report = batch_.report(env);
  const sim::RigidState<float>& x = state.rigid;
  const NoiseSettings& n = config_.noise;
  const auto noisy = [&](float value, double sigma) {
    return value + e.noise_level * static_cast<float>(sigma * normal(env, e));
  };
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  std::array<float, 3> up{noisy(r.r2.x, n.gravity), noisy(r.r2.y, n.gravity),
                          noisy(r.r2.z, n.gravity)};
  const float length = std::sqrt(up[0] * up[0] + up[1] * up[1] + up[2] * up[2]);
  for (float& u : up) u /= length;
  const std::array<float, 3> rate{noisy(x.angular_velocity.x, n.angular_velocity_radps),
                                  noisy(x.angular_velocity.y, n.angular_velocity_radps),
                                  noisy(x.angular_velocity.z, n.angular_velocity_radps)};
  JointArray<float> q, qd;
  for (int j = 0; j < kNumJoints; ++j) {
    q[j] = noisy(x.q[j] + e.joint_offset[j], n.joint_position_rad);
    qd[j] = noisy(x.qd[j], n.joint_velocity_radps);
  }
  const auto raw = make_observation<float>(e.command, up, rate, q, qd);
  auto observation = rollout.observation(t).col(env);
  for (int i = 0; i < kObservationSize; ++i) observation[i] = normalised(scales_, i, raw[i]);
  privileged(env, e, state, report, rollout.privileged(t).col(env).data());
  const auto estimate = truth(e, state);
  auto target = rollout.estimate_target(t).col(env);
  for (int i = 0; i < kEstimateSize; ++i) {
    target[i] = std::clamp((estimate[i] - scales_.estimate_mean[i]) / scales_.estimate_deviation[i],
                           -6.0f, 6.0f);
  }
}

void Task::observe(int block, int t, learner::Rollout& rollout) {
  for (int i = 0; i < block_envs_; ++i) observe_env(block * block_envs_ + i, t, rollout);
}

void Task::step(int block, int t, learner::Learner& learner, int worker) {
  learner::Rollout& rollout = learner.rollout();
  const int first = block * block_envs_;
  const auto clip = static_cast<float>(config_.policy.action_clip);
  const auto scale = static_cast<float>(config_.policy.action_scale_rad);
  for (int env = first; env < first + block_envs_; ++env) {
    Env& e = envs_[static_cast<std::size_t>(env)];
    e.drive.target_before = e.drive.target;
    const auto action = rollout.action(t).col(env);
    for (int j = 0; j < kNumJoints; ++j) {
      e.drive.target[j] =
          static_cast<float>(robot_.nominal_rad[j]) + scale * std::clamp(action[j], -clip, clip);
    }
    batch_.set_drive(env, e.drive);
  }
  const int width = batch_.width();
  for (int pack = first / width; pack < (first + block_envs_) / width; ++pack) {
    batch_.advance(pack, kTicksPerPolicyStep);
  }
  Sums& sums = sums_[static_cast<std::size_t>(block)];
  const auto length = static_cast<std::int32_t>(config_.episode.length_s * kPolicyHz);
  for (int env = first; env < first + block_envs_; ++env) {
    Env& e = envs_[static_cast<std::size_t>(env)];
    sim::RobotState<float> state = batch_.state(env);
    const sim::BatchReport<float> report = batch_.report(env);
    const sim::BatchSums<float> batch_sums = batch_.sums(env);
    const sim::RigidState<float>& x = state.rigid;
    const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);

    StepOutcome s;
    s.command = e.command;
    const float forward = std::max(std::sqrt(r.r0.x * r.r0.x + r.r1.x * r.r1.x), 1e-3f);
    s.vx = (r.r0.x * x.velocity.x + r.r1.x * x.velocity.y) / forward;
    s.vy = (r.r0.x * x.velocity.y - r.r1.x * x.velocity.x) / forward;
    s.vz = x.velocity.z;
    s.yaw_rate = dot(r.r2, x.angular_velocity);
    const auto keep = static_cast<float>(kStep_s / config_.reward.precise_time_s);
    const std::array<float, 3> now{s.vx, s.vy, s.yaw_rate};
    for (int i = 0; i < 3; ++i) e.drift[i] += std::min(keep, 1.0f) * (now[i] - e.drift[i]);
    s.drift = e.drift;
    s.roll_rate = x.angular_velocity.x;
    s.pitch_rate = x.angular_velocity.y;
    s.up_z = r.r2.z;
    const auto estimate = truth(e, state);
    s.body_height = estimate[0];
    s.q = x.q;
    const auto action = rollout.action(t).col(env);
    for (int j = 0; j < kNumJoints; ++j) {
      s.nominal[j] = static_cast<float>(robot_.nominal_rad[j]);
      s.action[j] = std::clamp(action[j], -clip, clip);
    }
    s.action_1 = e.action_1;
    s.action_2 = e.action_2;
    constexpr float kPerTick = 1.0f / kTicksPerPolicyStep;
    s.torque_squared = batch_sums.torque_squared * kPerTick;
    s.power = batch_sums.power * kPerTick;
    s.speed_squared = batch_sums.speed_squared * kPerTick;
    s.speed_excess = batch_sums.speed_excess * kPerTick;
    s.slip = batch_sums.slip * kPerTick;
    double lift_offs = 0.0;
    for (int l = 0; l < kNumLegs; ++l) {
      const bool was = e.unloaded_steps[l] < kUnloadedSteps;
      e.unloaded_steps[l] = batch_sums.foot_load[l] * kPerTick > kLoaded_n
                                ? 0
                                : std::min(e.unloaded_steps[l] + 1, 1000);
      const bool loaded = e.unloaded_steps[l] < kUnloadedSteps;
      e.air_s[l] = loaded ? 0.0f : e.air_s[l] + kStep_s;
      e.stance_s[l] = loaded ? e.stance_s[l] + kStep_s : 0.0f;
      lift_offs += was && !loaded;
      s.contact[l] = loaded;
      s.foot_clearance[l] = -report.penetration[l];
      const sim::Vec3<float>& v = report.foot_velocity[l];
      s.foot_speed[l] = std::sqrt(v.x * v.x + v.y * v.y);
    }
    s.air_s = e.air_s;
    s.stance_s = e.stance_s;

    const bool absurd = sim::diverged(x);
    const bool fell = batch_sums.base_contact > 0.0f || batch_sums.thigh_contact > 0.0f ||
                      r.r2.z < tilt_end_cos_ || absurd;
    const float value = absurd ? 0.0f : reward(s, config_.reward, cost_ramp_);
    rollout.reward(t, env) = value;

    const int kind = is_rigid(env) ? 0 : 1;
    if (!absurd) {
      const double kernel = velocity_kernel(s, config_.reward.velocity_width,
                                            config_.reward.velocity_width_per_speed2);
      sums.steps += 1.0;
      sums.reward += value;
      sums.torque_squared += s.torque_squared;
      sums.power += s.power;
      sums.lift_offs += lift_offs;
      sums.kernel[kind] += kernel;
      sums.kind_steps[kind] += 1.0;
      const double commanded = std::hypot(s.command[0], s.command[1]);
      if (commanded > 0.3) {
        sums.ratio[kind] += (s.vx * s.command[0] + s.vy * s.command[1]) / (commanded * commanded);
        sums.ratio_steps[kind] += 1.0;
        sums.abreast += 0.5 * (s.contact[0] == s.contact[1]) + 0.5 * (s.contact[2] == s.contact[3]);
        sums.diagonal +=
            0.5 * (s.contact[0] == s.contact[3]) + 0.5 * (s.contact[1] == s.contact[2]);
        for (const bool loaded : s.contact) sums.loaded += loaded / double(kNumLegs);
        sums.gait_steps += 1.0;
      }
      if (kind == 0) {
        sums.height += s.body_height;
        sums.height_steps += 1.0;
      } else if (s.command[0] > 0.75 * curriculum_.speed_mps) {
        sums.top_kernel += kernel;
        sums.top_steps += 1.0;
      }
    }

    e.action_2 = e.action_1;
    e.action_1 = s.action;
    ++e.step;
    if (fell) {
      rollout.end(t, env) = learner::End::kTerminated;
      sums.falls[kind] += 1.0;
      hard_reset(env, e);
      learner.reset_memory(env);
    } else if (e.step >= length) {
      rollout.end(t, env) = learner::End::kTimeout;
      std::array<float, kPrivileged> seen;
      privileged(env, e, state, report, seen.data());
      rollout.timeout_value(t, env) = learner.value(seen.data(), worker);
      if (uniform(env, e) < config_.episode.soft_reset_share) {
        // Soft reset: the robot goes on as it is, perhaps on other ground.
        e.step = 0;
        new_command(env, e);
        if (e.terrain.highest == 0.0f && uniform(env, e) < config_.episode.soft_reset_new_ground)
          new_ground(env, e, x.position.x);
      } else {
        hard_reset(env, e);
        learner.reset_memory(env);
      }
    } else {
      rollout.end(t, env) = learner::End::kNone;
      if (--e.command_steps_left <= 0) new_command(env, e);
      if (uniform(env, e) < config_.episode.push_probability) {
        push(env, e, state);
        batch_.set_state(env, state);
      }
    }
    observe_env(env, t + 1, rollout);
  }
}

WindowStats Task::end_window(double transitions) {
  Sums all;
  for (Sums& s : sums_) {
    all.steps += s.steps;
    all.reward += s.reward;
    all.torque_squared += s.torque_squared;
    all.power += s.power;
    all.height += s.height;
    all.height_steps += s.height_steps;
    all.lift_offs += s.lift_offs;
    all.abreast += s.abreast;
    all.diagonal += s.diagonal;
    all.loaded += s.loaded;
    all.gait_steps += s.gait_steps;
    all.top_kernel += s.top_kernel;
    all.top_steps += s.top_steps;
    for (int k = 0; k < 2; ++k) {
      all.kernel[k] += s.kernel[k];
      all.kind_steps[k] += s.kind_steps[k];
      all.falls[k] += s.falls[k];
      all.ratio[k] += s.ratio[k];
      all.ratio_steps[k] += s.ratio_steps[k];
    }
    s = {};
  }
  const auto mean = [](double sum, double n) { return n > 0.0 ? sum / n : 0.0; };
  WindowStats w;
  w.reward = mean(all.reward, all.steps);
  for (int k = 0; k < 2; ++k) {
    w.kernel[k] = mean(all.kernel[k], all.kind_steps[k]);
    w.falls[k] = mean(all.falls[k], all.kind_steps[k]) * 4.0 * kPolicyHz;
    w.speed_ratio[k] = mean(all.ratio[k], all.ratio_steps[k]);
  }
  w.top_kernel = mean(all.top_kernel, all.top_steps);
  w.top_count = all.top_steps;
  w.body_height_m = mean(all.height, all.height_steps);
  w.torque_squared = mean(all.torque_squared, all.steps);
  w.power_w = mean(all.power, all.steps);
  const double duty = mean(all.loaded, all.gait_steps);
  const double chance = duty * duty + (1.0 - duty) * (1.0 - duty);
  const auto together = [&](double sum) {
    return (mean(sum, all.gait_steps) - chance) / std::max(1.0 - chance, 1e-3);
  };
  w.abreast = together(all.abreast);
  w.diagonal = together(all.diagonal);
  w.stride_hz = mean(all.lift_offs, all.steps) / kNumLegs * kPolicyHz;

  const CommandSettings& c = config_.command;
  const GroundSettings& g = config_.ground;
  if (w.top_count > 0.0 && w.top_kernel > c.gate_kernel && w.falls[1] < c.gate_falls) {
    curriculum_.speed_mps = std::min(curriculum_.speed_mps + c.speed_step_mps, c.speed_max_mps);
  }
  if (w.kernel[1] > g.gate_kernel && w.falls[1] < g.gate_falls) {
    curriculum_.ground = std::min(curriculum_.ground + g.open_step, 1.0);
  }
  const RewardSettings& r = config_.reward;
  const double rise = std::min(transitions / r.cost_ramp_transitions, 1.0);
  const double late =
      std::clamp((transitions - r.cost_end_start_transitions) /
                     std::max(r.cost_end_transitions - r.cost_end_start_transitions, 1.0),
                 0.0, 1.0);
  cost_ramp_.all = r.cost_ramp_start + (1.0 - r.cost_ramp_start) * rise + (r.cost_end - 1.0) * late;
  cost_ramp_.energy = 1.0 + (r.energy_end - 1.0) * late;
  cost_ramp_.late = late;
  return w;
}

void Task::save(learner::Checkpoint& checkpoint) const {
  checkpoint.put("task.envs", envs_.data(), envs_.size());
  std::vector<sim::BatchRobot<float>> robots;
  for (int env = 0; env < batch_.size(); ++env) robots.push_back(batch_.robot(env));
  checkpoint.put("task.robots", robots.data(), robots.size());
  checkpoint.put("task.curriculum", &curriculum_, 1);
  checkpoint.put("task.cost_ramp", &cost_ramp_, 1);
}

void Task::load(const learner::Checkpoint& checkpoint) {
  checkpoint.get("task.envs", envs_.data(), envs_.size());
  std::vector<sim::BatchRobot<float>> robots(static_cast<std::size_t>(batch_.size()));
  checkpoint.get("task.robots", robots.data(), robots.size());
  for (int env = 0; env < batch_.size(); ++env)
    batch_.set_robot(env, robots[static_cast<std::size_t>(env)]);
  for (Sums& s : sums_) s = {};  // of a window that was not finished
  checkpoint.get("task.curriculum", &curriculum_, 1);
  checkpoint.get("task.cost_ramp", &cost_ramp_, 1);
}

}  // namespace sandrunner::train
