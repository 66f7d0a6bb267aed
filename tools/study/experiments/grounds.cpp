// SPDX-License-Identifier: BSD-3-Clause
// E3, E5 and E6: hard and springy grounds, turns, the air mattress and memory foam.
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

// 10 s on the spot, each way.
void add_turns(Lab& lab, const Model& model, const std::string& ground, double rate_radps,
               Measured& measured) {
  for (const double command : {rate_radps, -rate_radps}) {
    evaluate::Trial trial = lab.trial(sim::terrain_preset(ground), {0.0, 0.0, command});
    trial.duration_s = 10.0;
    measured.groups.push_back(turn_group(ground, command, lab.run(model, lab.repeat(trial))));
  }
}

}  // namespace

Measured run_grounds(Lab& lab, const Model& model) {
  Measured measured;
  for (const char* ground : {"vinyl", "athletic-track", "grass"}) {
    for (const double command : straight_commands()) {
      // As the paper: 5 m to speed up before the start line.
      evaluate::Trial trial = lab.trial(sim::terrain_preset(ground), {command, 0.0, 0.0});
      trial.duration_s = 6.0;
      trial.longest_s = 40.0;
      trial.track_begin_m = 5.0;
      trial.track_end_m = 10.0;
      measured.groups.push_back(straight_group(ground, command, lab.run(model, lab.repeat(trial))));
    }
  }
  for (const char* ground : {"dry-sand", "wet-sand", "grass", "athletic-track", "vinyl"}) {
    add_turns(lab, model, ground, 1.0, measured);
  }
  return measured;
}

Measured run_mattress(Lab& lab, const Model& model) {
  Measured measured;
  add_turns(lab, model, "air-mattress", 1.0, measured);
  // What the paper prints of Ours at 2 rad/s.
  if (std::string_view(model.controller->key) == "ours" || model.controller->is_published) {
    add_turns(lab, model, "air-mattress", 2.0, measured);
  }
  return measured;
}

Measured run_foam(Lab& lab, const Model& model) {
  constexpr double kFoamFrom_m = 2.0, kCommand_mps = 0.5;
  sim::TerrainDescription ground = sim::terrain_preset("rigid");
  ground.patches.push_back({kFoamFrom_m, sim::terrain_preset("memory-foam").patches[0].ground});
  evaluate::Trial trial = lab.trial(ground, {kCommand_mps, 0.0, 0.0});
  trial.duration_s = 12.0;
  trial.ground_changes_at_m = kFoamFrom_m;
  const std::vector<Ran> runs = lab.run(model, lab.repeat(trial));
  RunGroup group{"memory-foam", "", kCommand_mps, {}, {}};
  for (const Ran& run : runs) {
    group.runs["alive"].push_back(!run.figures.fell);
    group.runs["met"].push_back(run.figures.disturbance_met);
    group.runs["speed_before_mps"].push_back(mean_speed(run, 0.5, kFoamFrom_m));
    group.runs["speed_after_mps"].push_back(mean_speed(run, kFoamFrom_m + 0.5, 1e9));
  }
  for (const Sample& s : runs[0].samples) {
    group.lists["x_m"].push_back(s.x_m);
    double deepest = 0.0;
    for (const float depth : s.depth_m) deepest = std::max<double>(deepest, depth);
    group.lists["depth_m"].push_back(deepest);
    group.lists["speed_mps"].push_back(s.vx_mps);
  }
  return {{group}};
}

}  // namespace sandrunner::study
