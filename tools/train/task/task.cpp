// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/task.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "estimator/heading.h"
#include "rt/base/add_members.h"
#include "sim/ground/terrain_description.h"
#include "sim/step/divergence.h"
#include "tools/train/task/leg_modes.h"

namespace sandrunner::train {
namespace {

constexpr float kStep_s = 1.0f / kPolicyHz;

sim::StepSettings batch_settings() {
  sim::StepSettings s;
  // The soil's filter keeps its step of 4 kHz, so that its memory grows half as fast per reversal.
  s.dt_s = 1.0 / kSimulationHz;
  // A tumbling robot's contact problem need not be solved to the end: its episode is over.
  s.max_sweeps = 40;
  return s;
}

}  // namespace

Task::Task(const TaskConfig& config, const sim::Robot& robot, const TaskShape& shape,
           std::uint64_t seed)
    : config_(config),
      seed_(seed),
      block_envs_(shape.block_envs),
      robot_(robot),
      scales_(make_scales(robot_.nominal_rad, config.policy.body_height_m,
                          config.policy.observation_clip)),
      foot_(sim::make_foot_profile({}, robot_.model)),
      batch_(shape.envs, foot_, batch_settings(), shape.width),
      envs_(static_cast<std::size_t>(shape.envs)),
      sums_(static_cast<std::size_t>(shape.envs / shape.block_envs)),
      curriculum_{config.command.speed_start_mps, 0.0},
      schedule_(schedule_at(config.reward, 0.0, 0.0)),
      tilt_end_cos_(std::cos(config.episode.tilt_end_deg * std::numbers::pi / 180.0)) {
  restart(seed);
}

void Task::restart(std::uint64_t seed) {
  seed_ = seed;
  for (WindowSums& sums : sums_) sums = {};
  for (int env = 0; env < batch_.size(); ++env) {
    Env& e = envs_[static_cast<std::size_t>(env)];
    e = {};
    hard_reset(env, e, config_.episode.reset_nominal_share);
    // Episodes out of step with each other.
    e.step = static_cast<std::int32_t>(uniform(env, e) * config_.episode.length_s * kPolicyHz);
  }
}

void Task::step(int block, int t, learner::Rollout& rollout) {
  const int first = block * block_envs_, end = first + block_envs_;
  for (int env = first; env < end; ++env) set_targets(env, rollout.action(t).col(env).data());
  const int width = batch_.width();
  for (int pack = first / width; pack < end / width; ++pack) {
    batch_.advance(pack, kStepsPerAction);
  }
  for (int env = first; env < end; ++env) {
    end_step(env, t, rollout, sums_[static_cast<std::size_t>(block)]);
    observe_env(env, t + 1, rollout);
  }
}

void Task::set_targets(int env, const float* action) {
  Env& e = envs_[static_cast<std::size_t>(env)];
  const auto clip = static_cast<float>(config_.policy.action_clip);
  const auto scale = static_cast<float>(config_.policy.action_scale_rad);
  e.action_2 = e.action_1;
  e.action_1 = e.action;
  e.drive.target_before = e.drive.target;
  const bool a_step_late = e.latency_ticks > kStepsPerAction;
  if (config_.policy.in_joints) {
    std::copy_n(action, kNumJoints, e.action.begin());
  } else {
    joints_from_modes(config_.policy.mode_gain, action, 1, e.action.data());
  }
  for (int j = 0; j < kNumJoints; ++j) {
    e.action[j] = std::clamp(e.action[j], -clip, clip);
    const float target = static_cast<float>(robot_.nominal_rad[j]) + scale * e.action[j];
    e.drive.target[j] = a_step_late ? e.newest_target[j] : target;
    e.newest_target[j] = target;
  }
  batch_.set_drive(env, e.drive);
}

// What the step just done is judged by. Carries on what is remembered of velocities and feet.
StepOutcome Task::follow(Env& e, const sim::RobotState<float>& state,
                         const sim::BatchReport<float>& report,
                         const sim::BatchSums<float>& sums) const {
  constexpr float kPerTick = 1.0f / kStepsPerAction;
  const sim::RigidState<float>& x = state.rigid;
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  StepOutcome s;
  s.command = e.command;
  const Horizontal<float> velocity =
      in_heading_frame<float>({r.r0.x, r.r1.x}, {x.velocity.x, x.velocity.y});
  s.vx = velocity[0];
  s.vy = velocity[1];
  s.vz = x.velocity.z;
  s.yaw_rate = dot(r.r2, x.angular_velocity);
  const auto keep = static_cast<float>(kStep_s / config_.reward.drift_time_s);
  const std::array<float, 3> now{s.vx, s.vy, s.yaw_rate};
  for (int i = 0; i < 3; ++i) e.drift[i] += std::min(keep, 1.0f) * (now[i] - e.drift[i]);
  s.drift = e.drift;
  s.roll_rate = x.angular_velocity.x;
  s.pitch_rate = x.angular_velocity.y;
  s.up_z = r.r2.z;
  const sim::Shape<float>& shape = e.terrain.shape;
  if (shape.stretch > 1.0f) {
    const sim::Vec3<float> n = shape.plane_axes().n;
    s.vz = dot(n, x.velocity);
    s.up_z = dot(n, {r.r0.z, r.r1.z, r.r2.z});
  }
  s.body_height = truth(e, state)[0];
  s.q = x.q;
  for (int j = 0; j < kNumJoints; ++j) s.nominal[j] = static_cast<float>(robot_.nominal_rad[j]);
  s.action = e.action;
  s.action_1 = e.action_1;
  s.action_2 = e.action_2;
  s.torque_squared = sums.torque_squared * kPerTick;
  s.power = sums.power * kPerTick;
  s.speed_squared = sums.speed_squared * kPerTick;
  s.speed_excess = sums.speed_excess * kPerTick;
  s.past_stop = sums.ticks_past_stop * kPerTick;
  s.slip = sums.slip * kPerTick;
  for (int l = 0; l < kNumLegs; ++l) {
    const bool was_loaded = e.unloaded_steps[l] < kUnloadedSteps;
    e.unloaded_steps[l] =
        sums.foot_load[l] * kPerTick > sim::kLoaded_n ? 0 : std::min(e.unloaded_steps[l] + 1, 1000);
    s.contact[l] = e.unloaded_steps[l] < kUnloadedSteps;
    e.air_s[l] = s.contact[l] ? 0.0f : e.air_s[l] + kStep_s;
    e.stance_s[l] = s.contact[l] ? e.stance_s[l] + kStep_s : 0.0f;
    s.lift_offs += was_loaded && !s.contact[l];
    e.since_touchdown_s[l] += kStep_s;
    if (s.contact[l] && !was_loaded) s.stride_s[l] = std::exchange(e.since_touchdown_s[l], 0.0f);
    s.foot_clearance[l] = -report.penetration[l];
    const sim::Vec3<float>& v = report.foot_velocity[l];
    s.foot_speed[l] = std::sqrt(v.x * v.x + v.y * v.y);
  }
  s.air_s = e.air_s;
  s.stance_s = e.stance_s;
  return s;
}

// Judges the step just done and resets the robot if its episode is over.
void Task::end_step(int env, int t, learner::Rollout& rollout, WindowSums& window) {
  Env& e = envs_[static_cast<std::size_t>(env)];
  sim::RobotState<float> state = batch_.state(env);
  const sim::BatchReport<float> report = batch_.report(env);
  const sim::BatchSums<float> sums = batch_.sums(env);
  StepOutcome s = follow(e, state, report, sums);
  const bool absurd = sim::diverged(state.rigid, e.terrain.shape);
  const bool fell =
      sums.base_contact > 0.0f || sums.thigh_contact > 0.0f || s.up_z < tilt_end_cos_ || absurd;
  s.fell = fell;
  const int kind = is_rigid(env) ? 0 : 1;
  if (absurd) {  // a fall, and nothing else that figures could tell
    const penalty::Fall& fall = config_.reward.unbounded_penalties;
    const double value = fall.value(s, schedule_);
    rollout.reward(t, env) = static_cast<float>(-config_.reward.scale * value);
    if (details_ != nullptr) details_->terms[static_cast<std::size_t>(env)] = {};
  } else {
    const Reward earned = reward_of(s, config_.reward, schedule_);
    rollout.reward(t, env) = earned.value;
    window.add_step(s, earned, kind, decisive_kind(), curriculum_.speed_mps,
                    config_.reward.rewards);
    if (details_ != nullptr) {
      std::ranges::copy(earned.terms, details_->terms[static_cast<std::size_t>(env)].begin());
    }
  }
  ++e.step;
  rollout.reset(t + 1, env) = 0;
  const bool timeout = e.step >= static_cast<std::int32_t>(config_.episode.length_s * kPolicyHz);
  if (details_ != nullptr && (fell || timeout)) {
    auto& last = details_->final_observation[static_cast<std::size_t>(env)];
    last = {};
    const std::uint64_t draws = e.draws;  // the noise is drawn on the side
    if (!absurd) policy_input(env, e, state, last.data());
    e.draws = draws;
  }
  if (fell) {
    rollout.end(t, env) = learner::End::kTerminated;
    window.add_fall(kind);
    hard_reset(env, e, config_.episode.reset_nominal_share);
    rollout.reset(t + 1, env) = 1;
  } else if (timeout) {
    rollout.end(t, env) = learner::End::kTimeout;
    privileged(e, state, report, rollout.final_privileged(t).col(env).data());
    if (uniform(env, e) < config_.episode.soft_reset_share) {
      soft_reset(env, e, state.rigid.position.x);
    } else {
      hard_reset(env, e, config_.episode.reset_nominal_share);
      rollout.reset(t + 1, env) = 1;
    }
  } else {
    rollout.end(t, env) = learner::End::kNone;
    approach_target(e);
    if (--e.command_steps_left <= 0) new_command(env, e);
    const bool pushed = push(env, e, state), loosened = loosen(env, e, state);
    if (pushed || loosened) batch_.set_state(env, state);
  }
}

WindowStats Task::end_window(double transitions, double late) {
  WindowSums all;
  for (WindowSums& sums : sums_) {
    add_members<double>(sums, all);
    sums = {};
  }
  const WindowStats w = all.means();
  advance_curriculum(w);
  schedule_ = schedule_at(config_.reward, transitions, late);
  return w;
}

void Task::set_curriculum(const Curriculum& curriculum, double transitions, double late) {
  curriculum_ = curriculum;
  schedule_ = schedule_at(config_.reward, transitions, late);
}

void Task::advance_curriculum(const WindowStats& w) {
  const CommandSettings& c = config_.command;
  const GroundSettings& g = config_.ground;
  const int kind = decisive_kind();
  if (w.top_steps > 0.0 && w.top_kernel > c.gate_kernel && w.falls[kind] < c.gate_falls) {
    curriculum_.speed_mps = std::min(curriculum_.speed_mps + c.speed_step_mps, c.speed_max_mps);
  }
  if (w.kernel[kind] > g.gate_kernel && w.falls[kind] < g.gate_falls) {
    curriculum_.ground = std::min(curriculum_.ground + g.open_step, 1.0);
  }
}

void Task::save(learner::Checkpoint& checkpoint) const {
  checkpoint.put_envs("task.envs", envs_.data(), envs_.size());
  std::vector<sim::BatchRobot<float>> robots;
  for (int env = 0; env < batch_.size(); ++env) robots.push_back(batch_.robot(env));
  checkpoint.put_envs("task.robots", robots.data(), robots.size());
  checkpoint.put("task.curriculum", &curriculum_, 1);
  checkpoint.put("task.schedule", &schedule_, 1);
}

void Task::load(const learner::Checkpoint& checkpoint) {
  checkpoint.get("task.envs", envs_.data(), envs_.size());
  std::vector<sim::BatchRobot<float>> robots(static_cast<std::size_t>(batch_.size()));
  checkpoint.get("task.robots", robots.data(), robots.size());
  for (int env = 0; env < batch_.size(); ++env)
    batch_.set_robot(env, robots[static_cast<std::size_t>(env)]);
  for (WindowSums& sums : sums_) sums = {};  // of a window that was not finished
  checkpoint.get("task.curriculum", &curriculum_, 1);
  checkpoint.get("task.schedule", &schedule_, 1);
}

}  // namespace sandrunner::train
