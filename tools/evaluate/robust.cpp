// SPDX-License-Identifier: BSD-3-Clause
// Straight runs of 10 s on dry sand with one thing changed at a time.
#include <numbers>

#include "tools/evaluate/study.h"

namespace sandrunner::evaluate {
namespace {

struct Case {
  const char* name;
  Trial trial;
  double imu_turn_rad = 0.0;
};

sim::GroundParameters softer(sim::GroundParameters ground, double factor) {
  ground.sigma_flat_npm3 /= factor;
  ground.sigma_cone_npm3 /= factor;
  return ground;
}

// Each leg in a quarter of the runs, and the IMU turned to another side.
void turn_about(double imu_turn_rad, Group& group) {
  for (std::size_t i = 0; i < group.trials.size(); ++i) {
    Trial& t = group.trials[i];
    t.loose_step.leg = static_cast<int>(i % kNumLegs);
    const double turn_rad = i % 4 < 2 ? imu_turn_rad : -imu_turn_rad;
    (i % 2 == 0 ? t.sensors.imu_pitch_rad : t.sensors.imu_roll_rad) = static_cast<float>(turn_rad);
  }
}

}  // namespace

Part Study::robust() {
  Part part{"robust", {}};
  const sim::TerrainDescription sand = sim::terrain_preset("dry-sand"),
                                rigid = sim::terrain_preset("rigid");
  // Dry sand with other parameters.
  const auto changed = [&](auto change) {
    sim::TerrainDescription t = sand;
    change(t.patches[0].ground);
    return add(t);
  };
  const auto patch = [](sim::TerrainDescription& t, double from_x_m, sim::GroundParameters ground) {
    t.patches.push_back({from_x_m, ground});
  };
  const sim::GroundParameters& usual = sand.patches[0].ground;
  sim::TerrainDescription strip = sand, quarter = sand, half = sand, alternating = rigid;
  constexpr double kLooseFrom_m = 3.0, kLooseTo_m = 3.6, kHardTo_m = 2.0;
  patch(strip, kLooseFrom_m, softer(usual, 4.0));
  patch(strip, kLooseTo_m, usual);
  // Out of reach; one foot is moved there.
  patch(quarter, 1e9, softer(usual, 4.0));
  patch(half, 1e9, softer(usual, 2.0));
  for (int i = 1; i <= 4; ++i) {
    patch(alternating, kHardTo_m * i, (i % 2 == 1 ? sand : rigid).patches[0].ground);
  }

  const sim::Terrain<float>* const plain = add(sand);
  const auto on = [](const sim::Terrain<float>* terrain, auto... change) {
    Trial t;
    t.terrain = terrain;
    (change(t), ...);
    return t;
  };
  const auto late = [&](int ticks) {
    return on(plain, [&](Trial& t) { t.latency_ticks = ticks; });
  };
  const auto one_foot = [&](const sim::TerrainDescription& terrain) {
    return on(add(terrain), [](Trial& t) { t.loose_step.from_m = kLooseFrom_m; });
  };
  const auto changing = [&](const sim::TerrainDescription& terrain, double at_m) {
    return on(add(terrain), [&](Trial& t) { t.ground_changes_at_m = at_m; });
  };
  const Case cases[] = {
      {"plain", on(plain)},
      {"action delay 10 ms", late(kTicksPerPolicyStep)},
      {"action delay 20 ms", late(2 * kTicksPerPolicyStep)},
      {"IMU turned by 2 deg", on(plain), 2.0 / 180.0 * std::numbers::pi},
      {"3 x training noise", on(plain, [](Trial& t) { t.noise_scale = 3.0; })},
      {"pushes 0.6 m/s", on(plain, [](Trial& t) { t.push_speed_mps = 0.6; })},
      {"no inertial soil terms",
       on(changed([](sim::GroundParameters& g) { g.inertial_drag = g.added_mass = false; }))},
      {"sigma/4 under one foot", one_foot(quarter)},
      {"sigma/2 under one foot", one_foot(half)},
      {"sigma/4 from 3 to 3.6 m", changing(strip, kLooseFrom_m)},
      {"rigid-sand-rigid-sand-rigid", changing(alternating, kHardTo_m)},
      {"friction 0.4", on(changed([](sim::GroundParameters& g) { g.friction = 0.4; }))},
      {"softest: 1/0.15 MN/m3", on(changed([](sim::GroundParameters& g) {
         g.sigma_flat_npm3 = 1e6;
         g.sigma_cone_npm3 = 0.15e6;
       }))},
  };
  for (const Case& c : cases) {
    for (const double speed : {1.0, 2.0, 3.0}) {
      Trial trial = c.trial;
      trial.command.target.vx_mps = speed;
      trial.duration_s = 10.0;
      Group g = group("dry-sand", c.name, trial);
      turn_about(c.imu_turn_rad, g);
      part.groups.push_back(g);
    }
  }
  return part;
}

}  // namespace sandrunner::evaluate
