// SPDX-License-Identifier: BSD-3-Clause
// Straight runs of 10 s on dry sand with one thing changed at a time.
#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {

Part Study::robust() {
  Part part{"robust", {}};
  const sim::TerrainDescription sand = preset("dry-sand"), rigid = preset("rigid");
  // Dry sand with other parameters.
  const auto changed = [&](auto change) {
    sim::TerrainDescription t = sand;
    change(t.patches[0].ground);
    return add(t);
  };
  const auto patch = [](sim::TerrainDescription& t, double from_x_m, sim::GroundParameters ground) {
    t.patches.push_back({from_x_m, ground});
  };
  const auto softer = [&](double factor) {
    sim::GroundParameters ground = sand.patches[0].ground;
    ground.sigma_flat_npm3 /= factor;
    ground.sigma_cone_npm3 /= factor;
    return ground;
  };
  sim::TerrainDescription strip = sand, quarter = sand, half = sand, alternating = rigid;
  constexpr double kLooseFrom_m = 3.0, kLooseTo_m = 3.6, kHardTo_m = 2.0;
  patch(strip, kLooseFrom_m, softer(4.0));
  patch(strip, kLooseTo_m, sand.patches[0].ground);
  // Out of reach; one foot is moved there.
  patch(quarter, 1e9, softer(4.0));
  patch(half, 1e9, softer(2.0));
  for (int i = 1; i <= 4; ++i) {
    patch(alternating, kHardTo_m * i, (i % 2 == 1 ? sand : rigid).patches[0].ground);
  }

  struct Case {
    const char* name;
    Trial trial;
  };
  const sim::Terrain<float>* const plain = add(sand);
  const auto on = [](const sim::Terrain<float>* terrain) {
    Trial t;
    t.terrain = terrain;
    return t;
  };
  std::vector<Case> cases = {
      {"plain", on(plain)},
      {"action delay 10 ms", on(plain)},
      {"no inertial soil terms",
       on(changed([](sim::GroundParameters& g) { g.inertial_drag = g.added_mass = false; }))},
      {"3 x training noise", on(plain)},
      {"pushes 0.6 m/s", on(plain)},
      {"sigma/4 under one foot", on(add(quarter))},
      {"sigma/2 under one foot", on(add(half))},
      {"sigma/4 from 3 to 3.6 m", on(add(strip))},
      {"rigid-sand-rigid-sand-rigid", on(add(alternating))},
      {"friction 0.4", on(changed([](sim::GroundParameters& g) { g.friction = 0.4; }))},
      {"softest: 1/0.15 MN/m3", on(changed([](sim::GroundParameters& g) {
         g.sigma_flat_npm3 = 1e6;
         g.sigma_cone_npm3 = 0.15e6;
       }))},
  };
  cases[1].trial.latency_ticks = 40;
  cases[3].trial.noise_scale = 3.0;
  cases[4].trial.push_speed_mps = 0.6;
  cases[7].trial.ground_changes_at_m = kLooseFrom_m;
  cases[8].trial.ground_changes_at_m = kHardTo_m;
  cases[5].trial.loose_step.from_m = cases[6].trial.loose_step.from_m = kLooseFrom_m;
  for (const Case& c : cases) {
    for (const double speed : {1.0, 2.0, 3.0}) {
      Trial trial = c.trial;
      trial.command.target.vx_mps = speed;
      trial.duration_s = 10.0;
      Group g = group("dry-sand", c.name, trial);
      // Each leg in a quarter of the runs.
      for (std::size_t i = 0; i < g.trials.size(); ++i) {
        g.trials[i].loose_step.leg = static_cast<int>(i % kNumLegs);
      }
      part.groups.push_back(g);
    }
  }
  return part;
}

}  // namespace sandrunner::evaluate
