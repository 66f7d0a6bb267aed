// SPDX-License-Identifier: BSD-3-Clause
// The paper's grid of ground stiffness ("Evaluation in simulation"): episodes of 4 s under commands
// drawn at random.
#include <cmath>

#include "rt/core/command_shaping.h"
#include "sim/lanes/random.h"
#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {
namespace {

constexpr std::uint64_t kCommandStream = 13;
constexpr double kForwardLow_mps = -1.0, kForwardHigh_mps = 3.0, kLateral_mps = 0.5,
                 kYaw_radps = 1.0;

}  // namespace

Part Study::grid() {
  Part part{"grid", {}};
  for (int flat = 0; flat < kGridSize; ++flat) {
    for (int cone = 0; cone < kGridSize; ++cone) {
      sim::TerrainDescription ground = sim::terrain_preset("dry-sand");
      Group g;
      g.ground = "sand";
      g.sigma_flat_npm3 = 1e6 + 9e6 * flat / (kGridSize - 1);
      g.sigma_cone_npm3 = 0.15e6 + 0.45e6 * cone / (kGridSize - 1);
      ground.patches[0].ground.sigma_flat_npm3 = g.sigma_flat_npm3;
      ground.patches[0].ground.sigma_cone_npm3 = g.sigma_cone_npm3;
      const sim::Terrain<float>* terrain = add(ground);
      for (int run = 0; run < settings_.grid_runs; ++run) {
        std::uint64_t counter = 0;
        const auto draw = [&](double low, double high) {
          return low + (high - low) * sim::random_uniform(run_seed(run), kCommandStream, counter++);
        };
        Trial trial;
        trial.terrain = terrain;
        trial.start = &start(run);
        trial.seed = run_seed(run);
        trial.command.hold_s = 0.0;
        trial.command.acceleration = INFINITY;
        trial.command.target.vx_mps = draw(kForwardLow_mps, kForwardHigh_mps);
        trial.command.target.vy_mps = draw(-kLateral_mps, kLateral_mps);
        trial.command.target.wz_radps =
            shape_yaw_rate(draw(-kYaw_radps, kYaw_radps), trial.command.target.vx_mps,
                           trial.command.target.vy_mps, kCentripetalLimit_mps2);
        trial.duration_s = 4.0;
        g.trials.push_back(trial);
      }
      part.groups.push_back(g);
    }
  }
  return part;
}

}  // namespace sandrunner::evaluate
