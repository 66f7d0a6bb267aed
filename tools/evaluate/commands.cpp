// SPDX-License-Identifier: BSD-3-Clause
// Which commands a policy survives: forward by sideways and forward by turning, changing by
// 2 m/s^2 and 2 rad/s^2, each on three grounds.
#include <array>
#include <cmath>

#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {

double commanded_vx_mps(int column) { return -1.5 + 0.5 * column; }
double commanded_other(CommandPlane plane, int row) {
  const double step = plane == CommandPlane::kSideways ? 0.2 : 0.5;
  constexpr int kMiddle = kCommandRows / 2;
  return step * (row - kMiddle);
}

Part Study::commands() {
  Part part{"commands", {}};
  sim::TerrainDescription soft = sim::terrain_preset("dry-sand");
  soft.patches[0].ground.sigma_flat_npm3 = 1e6;
  soft.patches[0].ground.sigma_cone_npm3 = 0.15e6;
  struct Ground {
    const char* name;
    const sim::Terrain<float>* terrain;
  };
  const std::array<Ground, 3> grounds = {{{"dry-sand", add(sim::terrain_preset("dry-sand"))},
                                          {"rigid", add(sim::terrain_preset("rigid"))},
                                          {"soft", add(soft)}}};
  for (const CommandPlane plane : {CommandPlane::kSideways, CommandPlane::kTurning}) {
    const bool sideways = plane == CommandPlane::kSideways;
    for (const Ground& ground : grounds) {
      for (int column = 0; column < kCommandColumns; ++column) {
        for (int row = 0; row < kCommandRows; ++row) {
          Trial trial;
          trial.terrain = ground.terrain;
          trial.command.target.vx_mps = commanded_vx_mps(column);
          const double other = commanded_other(plane, row);
          (sideways ? trial.command.target.vy_mps : trial.command.target.wz_radps) = other;
          trial.command.acceleration = kCommandAcceleration;
          trial.duration_s = 6.0;
          part.groups.push_back(group(ground.name, sideways ? "vx by vy" : "vx by wz", trial));
        }
      }
    }
  }
  return part;
}

}  // namespace sandrunner::evaluate
