// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/terrain_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "rt/base/errors.h"
#include "rt/base/likely_meant.h"
#include "sim/ground/embedded.h"

namespace sandrunner::sim {
namespace {

const std::vector<std::string> kPresets = [] {
  std::vector<std::string> names = embedded_terrain_file_names();
  for (std::string& name : names) name = std::filesystem::path(name).stem();
  return names;
}();

// In the order of GroundKind.
constexpr const char* kKinds[] = {"granular", "rigid", "linear"};

// As short as it converts back: 60, not 59.99999999999999.
double degrees_of(double angle_rad) {
  const double degrees = angle_rad * (180.0 / std::numbers::pi);
  const double rounded = std::round(degrees * 1e9) / 1e9;
  return rounded * (std::numbers::pi / 180.0) == angle_rad ? rounded : degrees;
}

// Reads the ground under `prefix` ("terrain." or, in a patch, ""); a key that is missing leaves
// `p` as it is.
void read_ground(ConfigTree& c, const std::string& prefix, GroundParameters& p) {
  const auto number = [&](const char* key, double& value, double min, double max) {
    value = c.number(prefix + key, value, min, max);
  };
  const auto flag = [&](const char* key, bool& value) { value = c.flag(prefix + key, value); };
  const std::string kind =
      c.choice(prefix + "kind", kind_name(p.kind), {kKinds[0], kKinds[1], kKinds[2]});
  for (int i = 0; i < 3; ++i) {
    if (kind == kKinds[i]) p.kind = static_cast<GroundKind>(i);
  }
  number("friction", p.friction, 0.0, 5.0);
  number("sigma_flat_npm3", p.sigma_flat_npm3, 1.0, 1e10);
  number("sigma_cone_npm3", p.sigma_cone_npm3, 1.0, 1e10);
  number("recruitment", p.recruitment, 0.01, 20.0);
  double degrees = degrees_of(p.cone_angle_rad);
  number("cone_angle_deg", degrees, 5.0, 85.0);
  p.cone_angle_rad = degrees * (std::numbers::pi / 180.0);
  number("mass_scaling", p.mass_scaling, 0.0, 20.0);
  number("packing", p.packing, 0.0, 1.0);
  number("grain_density_kgpm3", p.grain_density_kgpm3, 0.0, 2e4);
  number("drag", p.drag, 0.0, 1e3);
  number("plastic_tolerance_m", p.plastic_tolerance_m, 0.0, 0.01);
  number("stroke_stiffness_npm", p.stroke_stiffness_npm, 0.0, 1e5);
  number("stroke_damping_nspm", p.stroke_damping_nspm, 0.0, 1e3);
  number("stroke_depth_scaling", p.stroke_depth_scaling, 0.0, 10.0);
  number("crater_radius_m", p.crater_radius_m, 0.0, 1.0);
  degrees = degrees_of(p.crater_angle_rad);
  number("crater_angle_deg", degrees, 5.0, 85.0);
  p.crater_angle_rad = degrees * (std::numbers::pi / 180.0);
  number("stiffness_npm", p.stiffness_npm, 1.0, 1e6);
  number("damping_nspm", p.damping_nspm, 0.0, 2e3);
  number("coupling_npm", p.coupling_npm, 0.0, 1e6);
  number("roughness_m", p.roughness_m, 0.0, 0.2);
  number("roughness_wavelength_m", p.roughness_wavelength_m, 0.05, 100.0);
  p.roughness_seed = static_cast<std::uint64_t>(c.integer(
      prefix + "roughness_seed", static_cast<std::int64_t>(p.roughness_seed), 0, 1LL << 40));
  flag("effects.inertial_drag", p.inertial_drag);
  flag("effects.added_mass", p.added_mass);
  flag("effects.plastic_memory", p.plastic_memory);
  flag("effects.healing", p.healing);
  flag("effects.filter", p.filter);
  flag("effects.stroke_resistance", p.stroke_resistance);
  flag("effects.gated_friction", p.gated_friction);
}

const std::string& checked_preset(const std::string& name) {
  if (std::find(kPresets.begin(), kPresets.end(), name) == kPresets.end()) {
    throw InputError(fmt::format("terrain.patch: preset '{}', expected one of {}{}", name,
                                 fmt::join(kPresets, ", "), did_you_mean(name, kPresets)));
  }
  return name;
}

}  // namespace

const char* kind_name(GroundKind kind) noexcept { return kKinds[static_cast<int>(kind)]; }

std::vector<std::string> terrain_preset_names() { return kPresets; }

void add_terrain_layer(ConfigTree& config, const std::string& preset_or_file) {
  if (std::find(kPresets.begin(), kPresets.end(), preset_or_file) != kPresets.end()) {
    config.add_text(embedded_terrain_file(preset_or_file + ".toml"), "preset " + preset_or_file);
    return;
  }
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(preset_or_file, unreadable)) {
    throw InputError(fmt::format("--terrain: '{}' is neither a preset ({}) nor a file{}",
                                 preset_or_file, fmt::join(kPresets, ", "),
                                 did_you_mean(preset_or_file, kPresets)));
  }
  config.add_file(preset_or_file);
}

TerrainDescription read_terrain(ConfigTree& config) {
  TerrainDescription terrain;
  terrain.name = config.text("terrain.name", "terrain");
  const std::string shape = config.choice("terrain.foot.shape", "tyre", {"tyre", "sphere", "disc"});
  terrain.foot_shape = shape == "tyre"     ? FootShape::kTyre
                       : shape == "sphere" ? FootShape::kSphere
                                           : FootShape::kDisc;
  terrain.hydraulic_factor = config.number("terrain.foot.hydraulic_factor", 0.0, 0.0, 10.0);
  TerrainPatch first;
  read_ground(config, "terrain.", first.ground);
  terrain.patches.push_back(first);
  for (ConfigTree& table : config.tables("terrain.patch")) {
    // A patch is a preset, or else the first ground, except for the keys it gives.
    TerrainPatch patch = terrain.patches.front();
    const std::string preset = table.text("preset", "");
    if (!preset.empty()) {
      ConfigTree layer;
      layer.add_text(embedded_terrain_file(checked_preset(preset) + ".toml"), "preset " + preset);
      patch.ground = {};
      read_ground(layer, "terrain.", patch.ground);
    }
    patch.from_x_m = table.number("from_x_m", 0.0, -1e4, 1e4);
    read_ground(table, "", patch.ground);
    if (terrain.patches.size() > 1 && patch.from_x_m <= terrain.patches.back().from_x_m) {
      throw InputError(fmt::format("terrain.patch: from_x_m {} after {}, expected ascending values",
                                   patch.from_x_m, terrain.patches.back().from_x_m));
    }
    terrain.patches.push_back(patch);
  }
  if (terrain.patches.size() > kMaxRegions) {
    throw InputError(fmt::format("terrain.patch: {} patches, expected at most {}",
                                 terrain.patches.size() - 1, kMaxRegions - 1));
  }
  return terrain;
}

FootProfile<double> make_foot_profile(const TerrainDescription& terrain,
                                      const RobotModel<double>& model) {
  // A robot with ball feet has no tyre.
  const FootShape shape = terrain.foot_shape == FootShape::kTyre && !(model.foot_width_m > 0.0)
                              ? FootShape::kSphere
                              : terrain.foot_shape;
  // 4 is that of the authors' code, with whose tyre the published stresses go. On it, buried, pi
  // r_h^2 is 2.63 times the patch; with 2 sqrt(2.63) it is as much of a disc, so that the same
  // ground carries both alike.
  const double factor = terrain.hydraulic_factor > 0.0 ? terrain.hydraulic_factor
                        : shape == FootShape::kTyre    ? 4.0
                                                       : 3.24;
  return fit_foot_profile(shape, model.foot_radius_m, model.foot_width_m, factor);
}

Terrain<double> make_terrain(const TerrainDescription& description, const FootProfile<double>& foot,
                             const RobotModel<double>& model) {
  Terrain<double> terrain;
  const std::size_t count = description.patches.size();
  terrain.count = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    terrain.ground[i] = derive_ground(description.patches[i].ground, foot, model.foot_radius_m);
    terrain.start_x[i] = description.patches[i].from_x_m;
    if (terrain.ground[i].coupling > 0.0) terrain.coupled = 1.0;
    terrain.highest = std::fmax(terrain.highest, highest_of(terrain.ground[i].roughness));
  }
  return terrain;
}

}  // namespace sandrunner::sim
