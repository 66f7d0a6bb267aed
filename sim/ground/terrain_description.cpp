// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/terrain_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "rt/base/errors.h"
#include "rt/base/likely_meant.h"
#include "sim/ground/embedded.h"
#include "sim/ground/height_grid.h"

namespace sandrunner::sim {
namespace {

const std::vector<std::string> kPresets = [] {
  std::vector<std::string> names = embedded_terrain_file_names();
  for (std::string& name : names) name = std::filesystem::path(name).stem();
  return names;
}();

// In the order of FootShape.
constexpr const char* kShapes[] = {"tyre", "sphere", "disc"};

using G = GroundParameters;
constexpr Setting<G> kGround[] = {
    {"kind", words<&G::kind>(Laws::kNames), "What the ground is: grains, hard, springs, or mud."},
    {"friction", &G::friction, 0.0, 5.0,
     "Coulomb coefficient between foot and ground; mud holds feet by its strength alone."},
    {"footprints", &G::footprints,
     "What a foot pressed down stays down for the next one; of soil and mud."},
    {"repose_deg", degrees(&G::repose_rad), 1.0, 80.0,
     "Steepest slope that footprints leave: the rest slips."},
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

void read_ground(ConfigTree& config, const std::string& table, GroundParameters& ground) {
  read_settings(config, table, kGround, ground);
  Laws::for_each([&]<template <typename> typename Law>(int) {
    using Parameters = typename Law<double>::Parameters;
    read_settings(config, table, Parameters::kSettings, static_cast<Parameters&>(ground));
  });
}

const std::string& checked_preset(const std::string& name) {
  if (std::find(kPresets.begin(), kPresets.end(), name) == kPresets.end()) {
    throw InputError(fmt::format("terrain.patch: preset '{}', expected one of {}{}", name,
                                 fmt::join(kPresets, ", "), did_you_mean(name, kPresets)));
  }
  return name;
}

}  // namespace

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

std::vector<SettingLine> terrain_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "terrain", kTerrain, ShapeParameters::kSettings, kGround);
  Laws::for_each([&]<template <typename> typename Law>(int) {
    list_settings(lines, "terrain", Law<double>::Parameters::kSettings);
  });
  list_settings(lines, "terrain.patch[]", kPatch);
  return lines;
}

TerrainDescription read_terrain(ConfigTree& config) {
  TerrainDescription terrain;
  read_settings(config, "terrain", kTerrain, terrain);
  ShapeParameters& shape = terrain.shape;
  read_settings(config, "terrain", ShapeParameters::kSettings, shape);
  if (!shape.heights_file.empty()) {
    shape.heights = std::make_shared<HeightGrid>(read_height_grid(shape.heights_file));
  }
  TerrainPatch first;
  read_ground(config, "terrain", first.ground);
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
      read_ground(layer, "terrain", patch.ground);
    }
    patch.from_x_m = keys.from_x_m;
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

}  // namespace sandrunner::sim
