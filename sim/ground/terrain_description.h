// SPDX-License-Identifier: BSD-3-Clause
// The terrain as a person describes it: a preset or a TOML file, and patches along x.
#pragma once

#include <string>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/settings.h"
#include "sim/ground/terrain.h"
#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

struct TerrainPatch {
  double from_x_m = 0.0;  ///< ignored for the first patch, which begins at minus infinity
  GroundParameters ground;
};

struct TerrainDescription {
  std::string name = "terrain";
  ShapeParameters shape;
  std::vector<TerrainPatch> patches;  ///< ascending in from_x_m; at least one, at most kMaxRegions
  FootShape foot_shape = FootShape::kTyre;
  double hydraulic_factor = 0.0;  ///< c_h of r_h = c_h A/P; 0: 4 for a tyre, else 3.24
};

/// Names of the presets built in: "dry-sand", "rigid", ...
std::vector<std::string> terrain_preset_names();

/// Adds a preset or file as a layer of `config`; `option` names it in errors. Throws InputError.
void add_terrain_layer(ConfigTree& config, const std::string& preset_or_file,
                       const std::string& option = "--terrain");

/// The preset of this name. Throws InputError.
TerrainDescription terrain_preset(const std::string& name);

/// Reads the table [terrain] of `config`. Throws InputError.
TerrainDescription read_terrain(ConfigTree& config);

/// The keys of the table [terrain], for the reference.
std::vector<SettingLine> terrain_settings();

/// The foot of a robot on this terrain, and the terrain with its constants derived.
FootProfile<double> make_foot_profile(const TerrainDescription& terrain,
                                      const RobotModel<double>& model);
Terrain<double> make_terrain(const TerrainDescription& terrain, const FootProfile<double>& foot,
                             const RobotModel<double>& model);

}  // namespace sandrunner::sim
