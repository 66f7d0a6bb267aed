// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/terrain_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

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

// In the order of GroundKind and of FootShape.
constexpr const char* kKinds[] = {"granular", "rigid", "linear"};
constexpr const char* kShapes[] = {"tyre", "sphere", "disc"};

using G = GroundParameters;
constexpr Setting<G> kGround[] = {
    {"kind", words<&G::kind>(kKinds), "What the ground is: grains, hard, or springs."},
    {"friction", &G::friction, 0.0, 5.0, "Coulomb coefficient between foot and ground."},
    {"sigma_flat_npm3", &G::sigma_flat_npm3, 1.0, 1e10,
     "Granular: stress gradient on the flat face of the cone of grains."},
    {"sigma_cone_npm3", &G::sigma_cone_npm3, 1.0, 1e10,
     "Granular: stress gradient on the side of the cone."},
    {"recruitment", &G::recruitment, 0.01, 20.0, "Granular: height that the cone gains per depth."},
    {"cone_angle_deg", degrees(&G::cone_angle_rad), 5.0, 85.0,
     "Granular: angle of the cone from the horizontal."},
    {"mass_scaling", &G::mass_scaling, 0.0, 20.0,
     "Granular: grains that move, over those in the cone."},
    {"packing", &G::packing, 0.0, 1.0, "Granular: volume fraction of the grains."},
    {"grain_density_kgpm3", &G::grain_density_kgpm3, 0.0, 2e4,
     "Granular: density of the grains' material."},
    {"drag", &G::drag, 0.0, 1e3, "Granular: scale of the inertial drag."},
    {"plastic_tolerance_m", &G::plastic_tolerance_m, 0.0, 0.01,
     "Granular: the force begins this much above the remembered depth."},
    {"stroke_stiffness_npm", &G::stroke_stiffness_npm, 0.0, 1e5,
     "Granular: stiffness against a foot that moves sideways."},
    {"stroke_damping_nspm", &G::stroke_damping_nspm, 0.0, 1e3,
     "Granular: damping against a foot that moves sideways."},
    {"stroke_depth_scaling", &G::stroke_depth_scaling, 0.0, 10.0,
     "Granular: weight of the depth in the resistance against moving sideways."},
    {"crater_radius_m", &G::crater_radius_m, 0.0, 1.0, "Granular: radius of the crater of a foot."},
    {"crater_angle_deg", degrees(&G::crater_angle_rad), 5.0, 85.0,
     "Granular: slope of the crater's wall."},
    {"stiffness_npm", &G::stiffness_npm, 1.0, 1e6, "Linear: spring under each foot."},
    {"damping_nspm", &G::damping_nspm, 0.0, 2e3, "Linear: damper under each foot."},
    {"coupling_npm", &G::coupling_npm, 0.0, 1e6,
     "Linear: force on each foot per depth of all feet together."},
    {"roughness_m", &G::roughness_m, 0.0, 0.2, "Rigid: standard deviation of its height; 0: flat."},
    {"roughness_wavelength_m", &G::roughness_wavelength_m, 0.05, 100.0,
     "Rigid: shortest wavelength of its height."},
    {"roughness_seed", &G::roughness_seed, 0, 0x1p40, "Rigid: seed of its height."},
    {"effects.inertial_drag", &G::inertial_drag, "Granular: drag of moving grains."},
    {"effects.added_mass", &G::added_mass, "Granular: inertia of moving grains."},
    {"effects.plastic_memory", &G::plastic_memory,
     "Granular: force only beyond the depth that is remembered."},
    {"effects.healing", &G::healing,
     "Granular: the remembered depth heals as the foot moves sideways."},
    {"effects.filter", &G::filter, "Granular: moving average of the normal force."},
    {"effects.stroke_resistance", &G::stroke_resistance,
     "Granular: resistance against a foot that moves sideways."},
    {"effects.gated_friction", &G::gated_friction,
     "Granular: friction only while the normal force acts."},
};

using T = TerrainDescription;
constexpr Setting<T> kTerrain[] = {
    {"name", &T::name, "Name of the ground in reports."},
    {"foot.shape", words<&T::foot_shape>(kShapes),
     "Shape of a foot to the ground; a robot with ball feet has no tyre."},
    {"foot.hydraulic_factor", &T::hydraulic_factor, 0.0, 10.0,
     "c_h of the hydraulic radius c_h A/P; 0: 4 for a tyre, else 3.24."},
};

// A patch has the keys of its ground, too.
struct PatchKeys {
  std::string preset;
  double from_x_m = 0.0;
};
constexpr Setting<PatchKeys> kPatch[] = {
    {"preset", &PatchKeys::preset,
     "Preset of the patch, which its other keys change; empty: the first ground."},
    {"from_x_m", &PatchKeys::from_x_m, -1e4, 1e4, "Where the patch begins; values ascend."},
};

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

void add_terrain_layer(ConfigTree& config, const std::string& preset_or_file,
                       const std::string& option) {
  if (std::find(kPresets.begin(), kPresets.end(), preset_or_file) != kPresets.end()) {
    config.add_text(embedded_terrain_file(preset_or_file + ".toml"), "preset " + preset_or_file);
    return;
  }
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(preset_or_file, unreadable)) {
    throw InputError(fmt::format("{}: '{}' is neither a preset ({}) nor a file{}", option,
                                 preset_or_file, fmt::join(kPresets, ", "),
                                 did_you_mean(preset_or_file, kPresets)));
  }
  config.add_file(preset_or_file);
}

TerrainDescription terrain_preset(const std::string& name) {
  ConfigTree config;
  add_terrain_layer(config, name);
  return read_terrain(config);
}

std::span<const Setting<GroundParameters>> ground_settings() noexcept { return kGround; }

std::vector<SettingLine> terrain_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "terrain", kTerrain);
  list_settings(lines, "terrain", kGround);
  list_settings(lines, "terrain.patch[]", kPatch);
  return lines;
}

TerrainDescription read_terrain(ConfigTree& config) {
  TerrainDescription terrain;
  read_settings(config, "terrain", kTerrain, terrain);
  TerrainPatch first;
  read_settings(config, "terrain", kGround, first.ground);
  terrain.patches.push_back(first);
  for (ConfigTree& table : config.tables("terrain.patch")) {
    // A patch is a preset, or else the first ground, except for the keys it gives.
    TerrainPatch patch = terrain.patches.front();
    PatchKeys keys;
    read_settings(table, "", kPatch, keys);
    if (!keys.preset.empty()) {
      ConfigTree layer;
      layer.add_text(embedded_terrain_file(checked_preset(keys.preset) + ".toml"),
                     "preset " + keys.preset);
      patch.ground = {};
      read_settings(layer, "terrain", kGround, patch.ground);
    }
    patch.from_x_m = keys.from_x_m;
    read_settings(table, "", kGround, patch.ground);
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
