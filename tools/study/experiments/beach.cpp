// SPDX-License-Identifier: BSD-3-Clause
// E1 and the fairness table: straight runs over a track of 5 m.
#include <cmath>
#include <cstddef>

#include "sim/lanes/random.h"
#include "tools/study/experiments/experiments.h"
#include "tools/study/simulated/plain_task.h"
#include "tools/study/simulated/task_run.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

// As the paper: placed 1 m before the start line of a track of 5 m.
evaluate::Trial straight_trial(Lab& lab, const sim::TerrainDescription& ground, double command) {
  evaluate::Trial trial = lab.trial(ground, {command, 0.0, 0.0});
  trial.duration_s = 6.0;
  trial.longest_s = 30.0;
  trial.track_begin_m = 1.0;
  trial.track_end_m = 6.0;
  return trial;
}

// The torques of the right legs over the last second of the run nearest to 1 m/s.
void add_torques(const std::vector<Ran>& runs, double& nearest, RunGroup& group) {
  const char* kNames[] = {"HAA", "HFE", "KFE"};
  for (const Ran& run : runs) {
    const double off = std::fabs(run.figures.track_speed_mps - 1.0);
    if (!(off < nearest) || run.samples.size() < kPolicyHz) continue;
    nearest = off;
    group.lists.clear();
    group.lists["speed_mps"] = {run.figures.track_speed_mps};
    for (std::size_t i = run.samples.size() - kPolicyHz; i < run.samples.size(); ++i) {
      for (int joint = 0; joint < kJointsPerLeg; ++joint) {
        for (const int leg : {1, 3}) {
          group.lists[std::string(leg == 1 ? "RF " : "RH ") + kNames[joint]].push_back(
              run.samples[i].torque_nm[kJointsPerLeg * leg + joint]);
        }
      }
    }
  }
}

// For a controller that sees the ground: in the training's environments, with its sensor noise.
Measured run_fairness_on_task(const Lab& lab, const Model& model) {
  constexpr int kBlock = 16, kSteps = 6 * kPolicyHz;
  constexpr double kInertia = 1.0;  // of our sands: as usual
  constexpr double kStart = 0.1;    // rad, m/s and rad/s; as in sandrunner-evaluate
  constexpr double kLatency_s = static_cast<double>(kLatency_ticks) / kControlHz;
  const sim::Robot& robot = lab.robot();
  const sim::TerrainDescription ground = training_ground(*model.controller, robot);
  const sim::FootProfile<double> foot = sim::make_foot_profile(ground, robot.model);
  const sim::Terrain<float> terrain =
      sim::convert_terrain<float>(sim::make_terrain(ground, foot, robot.model));
  TaskRun run{plain_task(robot)};
  run.task.noise.level_high = train::shipped_task_config(robot).noise.level_high;
  train::EpisodeSettings& start = run.task.episode;
  start.reset_joint_rad = start.reset_speed_mps = start.reset_rate_radps = kStart;
  start.reset_tilt_rad = 0.0;
  run.envs = (lab.settings().runs + kBlock - 1) / kBlock * kBlock;
  run.block_envs = kBlock;
  run.steps = kSteps;
  WorkerPool pool(lab.settings().threads);
  Measured measured;
  for (const double command : {1.0, 2.0, 3.0}) {
    train::Trial trial;
    trial.terrain = &terrain;
    trial.features = train::terrain_features(ground.patches[0].ground, kInertia);
    trial.command = {static_cast<float>(command), 0.0f, 0.0f};
    trial.stand_s = 0.5;
    trial.latency_s = kLatency_s;
    run.trials.assign(static_cast<std::size_t>(run.envs), trial);
    std::vector<double> alive(static_cast<std::size_t>(run.envs), 1.0);
    run_on_task(model.network, run, robot, pool, [&](const TaskStep& s) {
      for (int env = s.first_env; env < s.first_env + s.envs; ++env) {
        if (s.rollout.end(0, env) != learner::End::kNone)
          alive[static_cast<std::size_t>(env)] = 0.0;
      }
    });
    alive.resize(static_cast<std::size_t>(lab.settings().runs));
    measured.groups.push_back({"own", "", command, {{"alive", alive}}, {}});
  }
  return measured;
}

}  // namespace

sim::TerrainDescription beach(int run) {
  sim::TerrainDescription ground = sim::terrain_preset("dry-sand");
  if (run == 0) return ground;
  const auto draw = [&](int k, double low, double high) {
    const double u = sim::random_uniform(
        1, 21, 8 * static_cast<std::uint64_t>(run) + static_cast<std::uint64_t>(k));
    return low + u * (high - low);
  };
  sim::GroundParameters& g = ground.patches[0].ground;
  g.sigma_flat_npm3 *= std::exp(draw(0, -0.3, 0.3));
  g.sigma_cone_npm3 *= std::exp(draw(1, -0.3, 0.3));
  g.friction = draw(2, 0.6, 0.9);
  g.mass_scaling *= draw(3, 0.8, 1.2);  // of drag and added mass alike
  return ground;
}

sim::TerrainDescription training_ground(const Controller& controller, const sim::Robot& robot) {
  const std::string_view key = controller.key;
  if (key == "env-rigid" || key == "pl-rigid" || key == "teacher-rigid") {
    return sim::terrain_preset("rigid");
  }
  sim::TerrainDescription ground = sim::terrain_preset("dry-sand");
  sim::GroundParameters& g = ground.patches[0].ground;
  if (key == "env-quasistatic") g.inertial_drag = g.added_mass = false;
  if (key == "env-linear") {
    constexpr double kStiffness_npm = 10e3, kDampingRatio = 0.5;
    g.kind = sim::GroundKind::kLinear;
    g.stiffness_npm = kStiffness_npm;
    g.damping_nspm = train::spring_damping_nspm(kStiffness_npm, kDampingRatio, robot.model.mass());
  }
  return ground;
}

Measured run_fairness(Lab& lab, const Model& model) {
  if (!model.policy) return run_fairness_on_task(lab, model);
  Measured measured;
  for (const double command : {1.0, 2.0, 3.0}) {
    const auto ground = training_ground(*model.controller, lab.robot());
    const auto runs = lab.run(model, lab.repeat(straight_trial(lab, ground, command)));
    measured.groups.push_back(straight_group("own", command, runs));
  }
  return measured;
}

Measured run_beach(Lab& lab, const Model& model) {
  Measured measured;
  RunGroup torques{"beach", "torques", 1.0, {}, {}};
  double nearest = 0.5;  // m/s; a run that is further from 1 m/s shows nothing
  for (const double command : straight_commands()) {
    std::vector<evaluate::Trial> trials;
    const auto like = lab.repeat(straight_trial(lab, beach(0), command));
    for (std::size_t run = 0; run < like.size(); ++run) {
      trials.push_back(straight_trial(lab, beach(static_cast<int>(run)), command));
      trials.back().start = like[run].start;
      trials.back().seed = like[run].seed;
    }
    const std::vector<Ran> runs = lab.run(model, trials);
    measured.groups.push_back(straight_group("beach", command, runs));
    add_torques(runs, nearest, torques);
  }
  measured.groups.push_back(torques);
  return measured;
}

}  // namespace sandrunner::study
