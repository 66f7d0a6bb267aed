// SPDX-License-Identifier: BSD-3-Clause
// Ground beyond the paper's: slopes of dry sand, layers, mud.
#include <fmt/format.h>

#include <numbers>

#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {
namespace {

struct Way {
  const char* name;
  double heading_deg;  // of the slope, whose robots walk along x
};
constexpr Way kWays[] = {{"up", 0.0}, {"down", 180.0}, {"across", 90.0}};

}  // namespace

Part Study::beyond() {
  Part part{"beyond", {}};
  const auto walk = [&](const sim::TerrainDescription& terrain, const std::string& scenario) {
    std::vector<const sim::RobotState<float>*> starts;
    for (int run = 0; terrain.shape.slope_rad > 0.0 && run < settings_.runs; ++run) {
      starts.push_back(&start_on(terrain, run));
    }
    for (const double speed : {0.5, 1.0, 2.0}) {
      Trial trial;
      trial.terrain = add(terrain);
      trial.command.target.vx_mps = speed;
      trial.duration_s = 10.0;
      Group g = group(terrain.name, scenario, trial);
      for (std::size_t run = 0; run < starts.size(); ++run) g.trials[run].start = starts[run];
      part.groups.push_back(g);
    }
  };
  sim::TerrainDescription slope = sim::terrain_preset("dry-sand");
  for (int angle_deg = 5; angle_deg <= 25; angle_deg += 5) {
    for (const Way& way : kWays) {
      slope.shape.slope_rad = angle_deg * std::numbers::pi / 180.0;
      slope.shape.slope_heading_rad = way.heading_deg * std::numbers::pi / 180.0;
      walk(slope, fmt::format("{} deg {}", angle_deg, way.name));
    }
  }
  for (const char* name : {"turf", "dry-on-wet", "sand-on-rock", "mud", "swamp"}) {
    walk(sim::terrain_preset(name), "");
  }
  sim::TerrainDescription remembering = sim::terrain_preset("dry-sand");
  remembering.patches[0].ground.footprints = true;
  walk(remembering, "footprints");
  return part;
}

}  // namespace sandrunner::evaluate
