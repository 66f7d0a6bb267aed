// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/study.h"

#include <algorithm>
#include <cstddef>

#include "sim/lanes/lanes.h"
#include "sim/simulator.h"

namespace sandrunner::evaluate {

Study::Study(const StudySettings& settings, const sim::Robot& robot)
    : settings_(settings),
      robot_(robot),
      foot_(sim::make_foot_profile(sim::terrain_preset("dry-sand"), robot_.model)) {
  // A start serves for all grounds that are level.
  const sim::TerrainDescription level = sim::terrain_preset("rigid");
  for (int run = 0; run < std::max(settings.runs, settings.grid_runs); ++run) start_on(level, run);
}

const sim::RobotState<float>& Study::start_on(const sim::TerrainDescription& terrain, int run) {
  // The simulator makes it, so that there is one definition.
  sim::SimulatorConfig config;
  config.terrain = terrain;
  config.seed = run == 0 ? 0 : run_seed(run);
  sim::RobotState<float> start;
  start.rigid = sim::converted<float>(sim::Simulator(robot_, config).state().robot.rigid);
  return starts_.emplace_back(start);
}

std::uint64_t Study::run_seed(int run) const noexcept {
  return (settings_.seed - 1) * 1'000'000 + static_cast<std::uint64_t>(run);
}

const sim::Terrain<float>* Study::add(const sim::TerrainDescription& terrain) {
  terrains_.push_back(sim::convert_terrain<float>(sim::make_terrain(terrain, foot_, robot_.model)));
  return &terrains_.back();
}

Group Study::group(const std::string& ground, const std::string& scenario,
                   const Trial& like) const {
  Group g;
  g.ground = ground;
  g.scenario = scenario;
  g.command = like.command.target;
  for (int run = 0; run < settings_.runs; ++run) {
    Trial trial = like;
    trial.start = &start(run);
    trial.seed = run_seed(run);
    g.trials.push_back(trial);
  }
  return g;
}

}  // namespace sandrunner::evaluate
