// SPDX-License-Identifier: BSD-3-Clause
// The paper's straight run ("Beach sand"): 1 m, then a track of 5 m, on six grounds.
#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {

Part Study::straight() {
  Part part{"straight", {}};
  for (const char* name : {"dry-sand", "rigid", "wet-sand", "grass", "athletic-track", "vinyl"}) {
    const sim::Terrain<float>* terrain = add(sim::terrain_preset(name));
    for (int i = 1; i <= 8; ++i) {
      Trial trial;
      trial.terrain = terrain;
      trial.command.target.vx_mps = 0.5 * i;
      // Long enough that every command is steady in the second half; fast robots run on behind the
      // track.
      trial.duration_s = 6.0;
      trial.longest_s = 30.0;
      trial.track_begin_m = 1.0;
      trial.track_end_m = 6.0;
      part.groups.push_back(group(name, "", trial));
    }
  }
  return part;
}

}  // namespace sandrunner::evaluate
