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

TEST(LayerTest, NeverGivesEnergy) {
  // A mass of 5 kg that falls and lies, pushed by the force of each step.
  for (const double strength : {2.0, 10.0, 25.0}) {
    for (const double speed : {0.5, 2.0, 4.0}) {
      Foot foot(layered(0.03, strength));
      double z = 0.0, v = speed, work = 0.0;
      for (int i = 0; i < 8000; ++i) {
        const double force = foot.step({.z = z, .v = v}).normal, before = v;
        v += kDt_s * (kGravity_mps2 - force / 5.0);
        z += kDt_s * v;
        work -= force * 0.5 * (before + v) * kDt_s;
        ASSERT_LE(work, 1e-9) << strength << " " << speed;
      }
    }
  }
}

}  // namespace
}  // namespace sandrunner::sim
