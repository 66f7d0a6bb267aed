// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/curve_page.h"

#include <fmt/format.h>

#include "rt/run/process_config.h"
#include "rt/run/run.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "rt/telemetry/view/view_page.h"
#include "sim/ground/terrain_description.h"
#include "sim/simulator.h"

namespace sandrunner::train {
namespace {

constexpr const char* kGround = "dry-sand";
constexpr double kWalk_s = 6.0;
constexpr std::size_t kMostBytes = 2'000'000;

}  // namespace

std::string curve_page(const Progress& progress, const PolicyFile& file, double transitions,
                       const sim::Robot& robot, double speed_mps) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, kGround);
  const ProcessConfig config = read_process_config(tree, &file.spec, &robot);
  require_runnable(file.parameters);
  PolicyRunner policy(Policy(file.spec, Network(file.parameters)));
  sim::Simulator simulator(config.robot, config.simulator);
  const CommandSource command(fmt::format("{},0,0", speed_mps));
  RunScript script(command, {.walk_s = kWalk_s, .start_walking = true}, true);
  RunResult run = run_in_lockstep({.robot = simulator,
                                   .controller = config.controller,
                                   .start = Mode::kWalk,
                                   .policy = policy,
                                   .op = script},
                                  {.scene = scene_of(config, file.spec.name)});
  const auto& provenance = file.spec.provenance;
  return run_page(
      run.record, kMostBytes,
      progress.page_json(fmt::format("Training of {}: {:.2f} million transitions, {} core-hours; "
                                     "below: its policy, commanded {} "
                                     "m/s on {}",
                                     file.spec.name, 1e-6 * transitions,
                                     provenance.at("core_hours"), speed_mps, kGround)));
}

}  // namespace sandrunner::train
