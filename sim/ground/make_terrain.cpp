// SPDX-License-Identifier: BSD-3-Clause
// A described terrain as the steps take it.
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/ground/terrain_description.h"

namespace sandrunner::sim {

FootProfile<double> make_foot_profile(const TerrainDescription& terrain,
                                      const RobotModel<double>& model) {
  // A robot with ball feet has no tyre; a flat sole is a disc of its area.
  const bool flat = model.foot_length_m > 0.0;
  const FootShape shape = flat ? FootShape::kDisc
                          : terrain.foot_shape == FootShape::kTyre && !(model.foot_width_m > 0.0)
                              ? FootShape::kSphere
                              : terrain.foot_shape;
  const double radius_m =
      flat ? std::sqrt(model.foot_length_m * model.foot_width_m / std::numbers::pi)
           : model.foot_radius_m;
  // 4 is that of the authors' code, with whose tyre the published stresses go. On it, buried, pi
  // r_h^2 is 2.63 times the patch; with 2 sqrt(2.63) it is as much of a disc, so that the same
  // ground carries both alike.
  const double factor = terrain.hydraulic_factor > 0.0 ? terrain.hydraulic_factor
                        : shape == FootShape::kTyre    ? 4.0
                                                       : 3.24;
  FootProfile<double> foot = fit_foot_profile(shape, radius_m, model.foot_width_m, factor);
  foot.patches = static_cast<int>(model.foot_patches);
  return foot;
}

Terrain<double> make_terrain(const TerrainDescription& description, const FootProfile<double>& foot,
                             const RobotModel<double>& model) {
  Terrain<double> terrain;
  terrain.shape = derive_shape(description.shape);
  const std::size_t count = description.patches.size();
  terrain.count = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    terrain.ground[i] = derive_ground(description.patches[i].ground, foot, model.foot_radius_m);
    terrain.start_x[i] = description.patches[i].from_x_m;
    if (terrain.ground[i].coupling > 0.0) terrain.coupled = 1.0;
  }
  return terrain;
}

}  // namespace sandrunner::sim
