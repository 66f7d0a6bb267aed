// SPDX-License-Identifier: BSD-3-Clause
// Granular ground over a firmer layer: how far the layer is felt, and how strongly.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/sim/ground/granular_foot.h"

namespace sandrunner::sim {
namespace {

GroundParameters layered(double depth_m, double strength) {
  GroundParameters p;
  p.layer_depth_m = depth_m;
  p.layer_strength = strength;
  return p;
}

/// Quasistatic force over that without the layer.
double growth(const GroundParameters& p, double z) {
  GroundParameters deep = p;
  deep.layer_depth_m = 0.0;
  return Foot(p).quasistatic(z) / Foot(deep).quasistatic(z);
}

// The figures of eq. 5.35 of "Fundamentals of Foundation Engineering".
TEST(LayerTest, IsFeltAsFarAsTheRuptureOfAFootingReaches) {
  for (const auto& [friction_deg, widths] :
       {std::pair{28.0, 1.68}, std::pair{30.0, 1.83}, std::pair{32.0, 2.01}, std::pair{35.0, 2.32},
        std::pair{40.0, 3.07}}) {
    GroundParameters p = layered(0.4, 10.0);
    p.cone_angle_rad = std::numbers::pi / 4.0 + 0.5 * friction_deg * std::numbers::pi / 180.0;
    const double reach = (widths - 0.01) * kFootWidth_m, beyond = (widths + 0.01) * kFootWidth_m;
    EXPECT_GT(growth(p, p.layer_depth_m - reach), 1.0) << friction_deg;
    EXPECT_EQ(growth(p, p.layer_depth_m - beyond), 1.0) << friction_deg;
  }
}

TEST(LayerTest, StrengthRisesExponentiallyToThatOfTheLayer) {
  for (const double strength : {1.0, 2.0, 10.0, 25.0}) {
    const GroundParameters p = layered(0.2, strength);
    const double reach = 1.8305 * kFootWidth_m;
    EXPECT_NEAR(growth(p, 0.2), strength, 1e-12 * strength);
    EXPECT_NEAR(growth(p, 0.25), strength, 1e-12 * strength);
    EXPECT_NEAR(growth(p, 0.2 - 0.5 * reach), std::sqrt(strength), 1e-4 * strength);
    EXPECT_EQ(growth(p, 0.2 - 1.01 * reach), 1.0);
  }
}

TEST(LayerTest, AMassFallsLessDeepTheThinnerTheLayerAbove) {
  const auto depth_of_fall = [](const GroundParameters& p) {
    Foot foot(p);
    double z = 0.0, v = 2.0;
    while (v > 0.0) {
      v += kDt_s * (kGravity_mps2 - foot.step({.z = z, .v = v}).normal / 5.0);
      z += kDt_s * v;
    }
    return z;
  };
  double least = depth_of_fall(layered(0.0, 20.0));
  for (const double depth_m : {0.2, 0.15, 0.1, 0.05, 0.02}) {
    const double found = depth_of_fall(layered(depth_m, 20.0));
    EXPECT_LT(found, least) << depth_m;
    least = found;
  }
}

TEST(LayerTest, AMassThatLiesIsNotThrownUp) {
  // How far the energy of a mass that has fallen rises again: within the plastic tolerance a step's
  // force acts as a whole, or not.
  constexpr double kTolerance_m = 3e-4;
  for (const char* preset : {"turf", "dry-on-wet", "sand-on-rock"}) {
    for (const double dt : {0.25e-3, 0.5e-3}) {
      for (const double mass_kg : {0.2, 0.5, 5.0}) {
        Foot foot(terrain_preset(preset).patches[0].ground);
        foot.ground.filter_step = 100.0 * dt;
        double z = 0.0, v = 2.0, least = 1e9, most = 0.0;
        for (int i = 0; i < static_cast<int>(3.0 / dt); ++i) {
          const double force =
              foot_force(foot.ground, foot.profile, {.z = z, .v = v}, 1.0 / dt, foot.contact)
                  .normal;
          v += dt * (kGravity_mps2 - force / mass_kg);
          z += dt * v;
          const double energy = mass_kg * (0.5 * v * v - kGravity_mps2 * z);
          least = std::fmin(least, energy);
          most = std::fmax(most, energy - least);
        }
        EXPECT_LT(most, 1.1 * mass_kg * kGravity_mps2 * kTolerance_m + 3e-3)
            << preset << " " << mass_kg << " " << dt;
      }
    }
  }
}

}  // namespace
}  // namespace sandrunner::sim
