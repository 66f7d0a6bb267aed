// SPDX-License-Identifier: BSD-3-Clause
// Turning in place, walking sideways and backwards, standing.
#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {

Part Study::turn() {
  Part part{"turn", {}};
  struct Case {
    const char* scenario;
    VelocityCommand command;
  };
  constexpr Case kCases[] = {
      {"turn", {0.0, 0.0, 0.5}},       {"turn", {0.0, 0.0, -0.5}},
      {"turn", {0.0, 0.0, 1.0}},       {"turn", {0.0, 0.0, -1.0}},
      {"turn", {0.0, 0.0, 2.0}},       {"turn", {0.0, 0.0, -2.0}},
      {"sideways", {0.0, 0.5, 0.0}},   {"sideways", {0.0, -0.5, 0.0}},
      {"backwards", {-1.0, 0.0, 0.0}}, {"stand", {0.0, 0.0, 0.0}},
  };
  for (const char* name : {"dry-sand", "rigid"}) {
    const sim::Terrain<float>* terrain = add(sim::terrain_preset(name));
    for (const Case& c : kCases) {
      Trial trial;
      trial.terrain = terrain;
      trial.command.target = c.command;
      trial.duration_s = 10.0;
      part.groups.push_back(group(name, c.scenario, trial));
    }
  }
  return part;
}

}  // namespace sandrunner::evaluate
