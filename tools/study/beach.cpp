// SPDX-License-Identifier: BSD-3-Clause
// E1 and the fairness table: straight runs over a track of 5 m.
#include <cmath>
#include <cstddef>

#include "sim/lanes/random.h"
#include "tools/study/experiments.h"

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

}  // namespace

sim::TerrainDescription beach(int run) {
  sim::TerrainDescription ground = evaluate::Study::preset("dry-sand");
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
    return evaluate::Study::preset("rigid");
  }
  sim::TerrainDescription ground = evaluate::Study::preset("dry-sand");
  sim::GroundParameters& g = ground.patches[0].ground;
  if (key == "env-quasistatic") g.inertial_drag = g.added_mass = false;
  if (key == "env-linear") {
    constexpr double kStiffness_npm = 10e3, kDampingRatio = 0.5;
    g.kind = sim::GroundKind::kLinear;
    g.stiffness_npm = kStiffness_npm;
    g.damping_nspm =
        2.0 * kDampingRatio * std::sqrt(kStiffness_npm * robot.model.mass() / kNumLegs);
  }
  return ground;
}

Measured run_fairness(Lab& lab, const Model& model) {
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
