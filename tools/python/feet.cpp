// SPDX-License-Identifier: BSD-3-Clause
#include "tools/python/feet.h"

#include <fmt/format.h>

#include "tools/python/checks.h"

namespace sandrunner::python {
namespace {

FootForce force_of(const sim::Terrain<double>& terrain, const sim::FootProfile<double>& foot,
                   const double* position, const double* velocity, double rate_hz,
                   sim::FootContact<double>& contact) noexcept {
  if (contact.active == 0.0) contact.region = terrain.region_at(position[0]);
  const sim::Ground<double>& ground = terrain.ground[static_cast<std::size_t>(contact.region)];
  const sim::FootMotion<double> motion{.x = position[0],
                                       .y = position[1],
                                       .z = -position[2],
                                       .v = -velocity[2],
                                       .vx = velocity[0],
                                       .vy = velocity[1]};
  const sim::FootForce<double> f =
      share_of(sim::foot_force(ground, foot, motion, rate_hz, contact), 1.0 / foot.patches);
  return {.normal = f.normal,
          .raw = f.raw,
          .friction_bound = f.friction_bound,
          .stroke_x = -f.stroke * f.direction_x,
          .stroke_y = -f.stroke * f.direction_y};
}

}  // namespace

Feet::Feet(const std::string& ground, const std::vector<std::string>& settings,
           const FootSize& size) {
  sim::RobotModel<double> model;
  model.foot_radius_m = checked("foot_radius_m", size.radius_m, 1e-3, 1.0);
  model.foot_width_m = checked("foot_width_m", size.width_m, 0.0, 1.0);
  model.foot_length_m = checked("foot_length_m", size.length_m, 0.0, 1.0);
  if (size.length_m > 0.0 && size.width_m == 0.0) {
    throw InputError("foot_width_m: found 0, expected that of a sole of this length");
  }
  model.foot_patches = size.patches;
  const sim::TerrainDescription description = read_ground(ground, settings);
  for (const sim::TerrainPatch& patch : description.patches) {
    if (patch.ground.is_hard()) {
      throw InputError(fmt::format(
          "ground: found '{}', which is hard: expected one that yields, with a law of force",
          description.name));
    }
    if (patch.ground.footprints) {
      throw InputError(fmt::format(
          "ground: found '{}' with footprints, expected one without: it does not know where a foot "
          "of another simulator steps next",
          description.name));
    }
    if (patch.ground.coupling_npm > 0.0) {
      throw InputError(fmt::format(
          "ground: found '{}', which couples the feet of a robot: expected one with a law for each",
          description.name));
    }
  }
  foot_ = sim::make_foot_profile(description, model);
  terrain_ = sim::make_terrain(description, foot_, model);
  if (terrain_.shape.uneven > 0.0) {
    throw InputError(fmt::format(
        "ground: found '{}', which is not level, expected level ground: measure the depth "
        "along the normal of a surface of your own",
        description.name));
  }
}

void Feet::step(std::size_t count, const double* position, const double* velocity, double step_s,
                sim::FootContact<double>* contacts, FootForce* forces) const noexcept {
  sim::Terrain<double> terrain = terrain_;
  // The filter's constant is meant for the simulator's own step.
  for (auto& ground : terrain.ground) ground.filter_step *= step_s / kControlPeriod_s;
  for (std::size_t i = 0; i < count; ++i, position += 3, velocity += 3) {
    forces[i] = force_of(terrain, foot_, position, velocity, 1.0 / step_s, contacts[i]);
  }
}

}  // namespace sandrunner::python
