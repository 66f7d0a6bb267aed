// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/battery.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "estimator/heading.h"
#include "rt/core/messages.h"
#include "sim/ground/terrain_description.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::train {
namespace {

// Of the battery's own draws: the same for every training, so that their figures compare.
constexpr std::uint64_t kSeed = 20'000'003;
constexpr int kBlock = static_cast<int>(sim::BatchWidth::kSixteen);
constexpr double kStand_s = 0.5;      // as in sandrunner-evaluate
constexpr double kStart = 0.1;        // rad, m/s and rad/s by which starts are disturbed; likewise
constexpr double kYawLength_m = 0.5;  // a yaw rate as a speed
// Of springs: damping ratio of a quarter of the robot, and friction as on dry sand.
constexpr double kSpringDamping = 0.5, kSpringFriction = 0.8;

// The training's task without what is drawn.
TaskConfig without_randomness(const TaskConfig& training) {
  TaskConfig c = without_variety(training);
  c.episode.reset_joint_rad = c.episode.reset_speed_mps = c.episode.reset_rate_radps = kStart;
  c.episode.reset_tilt_rad = 0.0;
  c.robot.latency_s = training.robot.latency_s;
  c.noise = {};
  return c;
}

int whole_blocks(std::size_t runs) {
  return (static_cast<int>(runs) + kBlock - 1) / kBlock * kBlock;
}

double square(double v) { return v * v; }

double length(const std::array<double, 3>& v) {
  return std::sqrt(square(v[0]) + square(v[1]) + square(kYawLength_m * v[2]));
}

}  // namespace

double score_of(const BatteryFigures& f, const BatterySettings& s, double most_alive) {
  const double cost = std::isfinite(f.cost_of_transport) ? f.cost_of_transport : 0.0;
  return -(1000.0 * std::max(0.0, most_alive - kAlike - f.alive) +
           1000.0 * std::max(0.0, f.error - s.tracked_error) + cost +
           s.too_fast_weight * f.too_fast +
           s.drift_weight * (f.drift_mps + kYawLength_m * f.yaw_drift_radps));
}

Battery::Battery(const BatterySettings& settings, const TaskConfig& training, int block_envs,
                 const sim::Robot& robot, const learner::ParameterLayout& layout, WorkerPool& pool)
    : settings_(settings),
      robot_(robot),
      grounds_(make_grounds(settings, training.ground, block_envs, robot)),
      runs_(make_runs(settings, training, grounds_)),
      steps_(static_cast<int>(std::lround(settings.duration_s * kPolicyHz))),
      task_(without_randomness(training), robot, {whole_blocks(runs_.size()), kBlock}, kSeed),
      rollout_({whole_blocks(runs_.size()), 1, Task::privileged_size(),
                layout.sizes().wiring.sees_insight() ? kInsightSize : 0},
               layout.memory()),
      weights_(layout),
      pool_(pool),
      memory_(layout.memory(), whole_blocks(runs_.size())),
      sums_(static_cast<std::size_t>(whole_blocks(runs_.size()))) {
  for (int worker = 0; worker < pool.threads(); ++worker) {
    passes_.emplace_back(layout, 1, kBlock, 1);
  }
}

std::deque<Battery::Ground> Battery::make_grounds(const BatterySettings& settings,
                                                  const GroundSettings& g, int block_envs,
                                                  const sim::Robot& robot) {
  const bool patchy = g.patchy_envs > 0;
  const bool hard = g.rigid_envs > 0 || (patchy && g.patch_rigid_share > 0.0);
  const bool yields =
      g.rigid_envs + g.patchy_envs < block_envs || (patchy && g.patch_rigid_share < 1.0);
  std::deque<Ground> grounds;
  // factor: as of terrain_features.
  const auto add = [&](const sim::TerrainDescription& terrain, double factor) {
    const auto foot = sim::make_foot_profile(terrain, robot.model);
    grounds.push_back({terrain.name,
                       sim::convert_terrain<float>(sim::make_terrain(terrain, foot, robot.model)),
                       terrain_features(terrain.patches.front().ground, factor)});
  };
  if (hard) add(sim::terrain_preset("rigid"), 1.0);
  if (!yields) return grounds;
  if (g.yielding == sim::GroundKind::kLinear) {
    for (const auto& [name, wanted_npm] :
         {std::pair{"stiff-spring", 33e3}, std::pair{"spring", 10e3}, std::pair{"soft-spring", 4e3},
          std::pair{"softest", settings.softest_spring_npm}}) {
      sim::TerrainDescription spring = sim::terrain_preset("athletic-track");
      spring.name = name;
      sim::GroundParameters& p = spring.patches.front().ground;
      p.stiffness_npm = std::clamp(wanted_npm, g.spring_low, g.spring_high);
      const double ratio =
          std::clamp(kSpringDamping, g.spring_damping_ratio_low, g.spring_damping_ratio_high);
      p.damping_nspm = spring_damping_nspm(p.stiffness_npm, ratio, robot.model.mass());
      p.friction = kSpringFriction;
      add(spring, ratio);
    }
    return grounds;
  }
  const double inertial = std::clamp(1.0, g.inertial_low, g.inertial_high);
  const auto add_soil = [&](sim::TerrainDescription terrain) {
    terrain.patches.front().ground.grain_density_kgpm3 *= inertial;
    add(terrain, inertial);
  };
  for (const char* name : {"wet-sand", "grass", "dry-sand"}) {
    const sim::TerrainDescription terrain = sim::terrain_preset(name);
    const sim::GroundParameters& p = terrain.patches.front().ground;
    const bool within =
        p.sigma_flat_npm3 >= g.sigma_flat_low && p.sigma_flat_npm3 <= g.sigma_flat_high &&
        p.sigma_cone_npm3 >= g.sigma_cone_low && p.sigma_cone_npm3 <= g.sigma_cone_high;
    if (within) add_soil(terrain);
  }
  sim::TerrainDescription softest = sim::terrain_preset("dry-sand");
  softest.name = "softest";
  sim::GroundParameters& p = softest.patches.front().ground;
  p.sigma_flat_npm3 = std::clamp(settings.softest_flat_npm3, g.sigma_flat_low, g.sigma_flat_high);
  p.sigma_cone_npm3 = std::clamp(settings.softest_cone_npm3, g.sigma_cone_low, g.sigma_cone_high);
  add_soil(softest);
  return grounds;
}

std::vector<Battery::Run> Battery::make_runs(const BatterySettings& settings,
                                             const TaskConfig& training,
                                             const std::deque<Ground>& grounds) {
  const CommandSettings& c = training.command;
  const auto& latency_s = training.robot.latency_s;
  std::vector<Run> runs;
  for (const Ground& ground : grounds) {
    const auto add = [&](int speed, const std::array<double, 3>& command, int count) {
      for (int i = 0; i < count; ++i) {
        Trial trial;
        trial.terrain = &ground.terrain;
        trial.features = ground.features;
        for (std::size_t k = 0; k < 3; ++k) trial.command[k] = static_cast<float>(command[k]);
        trial.stand_s = kStand_s;
        trial.latency_s = latency_s[static_cast<std::size_t>(i) % latency_s.size()];
        trial.nominal_start = i % 2 == 0;
        runs.push_back({trial, speed});
      }
    };
    for (std::size_t k = 0; k < kForwardSpeeds; ++k) {
      add(static_cast<int>(k), {settings.forward_share[k] * c.speed_max_mps, 0.0, 0.0},
          settings.runs);
    }
    const int others = (settings.runs + 1) / 2;
    if (c.backward_mps > 0.0) add(-1, {-c.backward_mps, 0.0, 0.0}, others);
    for (const double side : {1.0, -1.0}) {
      if (c.lateral_mps > 0.0) add(-1, {0.0, side * c.lateral_mps, 0.0}, others);
      if (c.yaw_radps > 0.0) add(-1, {0.0, 0.0, side * c.yaw_radps}, others);
    }
  }
  return runs;
}

BatteryFigures Battery::run(const std::vector<float>& parameters, const learner::Ranks& ranks) {
  weights_.set(parameters.data());
  memory_.setZero();
  std::ranges::fill(sums_, Sums{});
  const int blocks = static_cast<int>(sums_.size()) / kBlock;
  const learner::Share own = ranks.share(blocks);
  pool_.run(own.size(), [&](int i, int worker) { run_block(own.begin + i, worker); });
  ranks.gather(std::span(sums_), blocks);
  return figures();
}

void Battery::run_block(int block, int worker) {
  const int first = block * kBlock;
  for (int env = first; env < first + kBlock; ++env) {
    // Environments beyond the last run repeat it; nobody counts them.
    const std::size_t run = std::min(static_cast<std::size_t>(env), runs_.size() - 1);
    task_.begin_trial(env, runs_[run].trial);
    rollout_.reset(0, env) = 1;
  }
  task_.observe(block, 0, rollout_);
  learner::BlockPass<float>& pass = passes_[static_cast<std::size_t>(worker)];
  for (int step = 0; step < steps_; ++step) {
    pass.answer(weights_, rollout_.observation(0).middleCols(first, kBlock),
                rollout_.insight(0).middleCols(first, kBlock), &rollout_.reset(0, first),
                memory_.middleCols(first, kBlock), rollout_.action(0).middleCols(first, kBlock));
    std::array<std::array<float, 3>, kBlock> command;
    for (int i = 0; i < kBlock; ++i) {
      command[static_cast<std::size_t>(i)] = task_.command(first + i);
    }
    task_.step(block, 0, rollout_);
    for (int env = first; env < first + kBlock; ++env) {
      const bool steady = 2 * step >= steps_;
      add_step(env, command[static_cast<std::size_t>(env - first)], steady);
    }
    rollout_.begin_next(first, kBlock);
  }
}

void Battery::add_step(int env, const std::array<float, 3>& command, bool steady) {
  constexpr double kPerTick = 1.0 / kStepsPerAction;
  Sums& s = sums_[static_cast<std::size_t>(env)];
  s.fell = s.fell || rollout_.end(0, env) != learner::End::kNone;
  if (s.fell) return;
  const sim::BatchSums<float> sums = task_.batch().sums(env);
  s.too_fast += sums.ticks_too_fast * kPerTick;
  if (!steady) return;
  s.power += sums.power * kPerTick;
  s.torque_squared += sums.torque_squared * kPerTick;
  const sim::RigidState<float> x = task_.batch().state(env).rigid;
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  const Horizontal<float> velocity =
      in_heading_frame<float>({r.r0.x, r.r1.x}, {x.velocity.x, x.velocity.y});
  const std::array<float, 3> now{velocity[0], velocity[1], dot(r.r2, x.angular_velocity)};
  for (std::size_t k = 0; k < 3; ++k) {
    s.velocity[k] += now[k];
    s.command[k] += command[k];
  }
}

BatteryFigures Battery::figures() const {
  struct Mean {
    double sum = 0.0, count = 0.0;
    void add(double value) {
      sum += value;
      count += 1.0;
    }
    double value(double without) const { return count > 0.0 ? sum / count : without; }
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Mean alive, error, cost, too_fast, drift, yaw_drift;
  std::array<Mean, kForwardSpeeds> alive_at, cost_at;
  const int steady_from = (steps_ + 1) / 2;
  const double steady = steps_ - steady_from;
  const double weight_n = robot_.model.mass() * kGravity_mps2;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const Sums& s = sums_[i];
    const int speed = runs_[i].speed;
    alive.add(s.fell ? 0.0 : 1.0);
    if (speed >= 0) alive_at[static_cast<std::size_t>(speed)].add(s.fell ? 0.0 : 1.0);
    if (s.fell) continue;
    too_fast.add(s.too_fast / steps_);
    std::array<double, 3> off{};
    for (std::size_t k = 0; k < 3; ++k) off[k] = s.velocity[k] - s.command[k];
    error.add(length(off) / length(s.command));
    if (speed < 0) continue;
    drift.add(std::fabs(s.velocity[1]) / steady);
    yaw_drift.add(std::fabs(s.velocity[2]) / steady);
    const double speed_mps = std::hypot(s.velocity[0], s.velocity[1]) / steady;
    if (speed_mps < 0.05) continue;  // as in sandrunner-evaluate
    const double power =
        (s.power + s.torque_squared / square(robot_.motor_constant_nmpsqrtw[0])) / steady;
    cost_at[static_cast<std::size_t>(speed)].add(power / (weight_n * speed_mps));
  }
  BatteryFigures f;
  f.alive = alive.value(0.0);
  f.error = error.value(1.0);
  f.too_fast = too_fast.value(0.0);
  f.drift_mps = drift.value(0.0);
  f.yaw_drift_radps = yaw_drift.value(0.0);
  for (std::size_t k = 0; k < kForwardSpeeds; ++k) {
    f.alive_at[k] = alive_at[k].value(0.0);
    f.cost_of_transport_at[k] = cost_at[k].value(kNan);
    if (cost_at[k].count > 0.0) cost.add(f.cost_of_transport_at[k]);
  }
  f.cost_of_transport = cost.value(kNan);
  return f;
}

std::vector<Battery::Survival> Battery::survival() const {
  std::vector<Survival> all;
  for (const Ground& ground : grounds_) {
    Survival of_ground{ground.name, {}};
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const Run& run = runs_[i];
      if (run.trial.terrain != &ground.terrain || run.speed < 0 || sums_[i].fell) continue;
      ++of_ground.alive[static_cast<std::size_t>(run.speed)];
    }
    all.push_back(of_ground);
  }
  return all;
}

std::vector<std::string> Battery::grounds() const {
  std::vector<std::string> names;
  for (const Ground& ground : grounds_) names.push_back(ground.name);
  return names;
}

}  // namespace sandrunner::train
