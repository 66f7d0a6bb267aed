// SPDX-License-Identifier: BSD-3-Clause
// The chapter on the ground: each of its values as recorded, so that a change of the contact law
// that moves one is seen.
#include "tools/study/anchors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandrunner::study {
namespace {

struct Recorded {
  const char* quantity;
  double ours;
};

TEST(AnchorsTest, NoValueOfOursDriftsByMoreThanOnePercent) {
  constexpr Recorded kRecorded[] = {
      {"x", 0.0},
  };
  const std::vector<Anchor> found = ground_anchors();
  ASSERT_EQ(found.size(), std::size(kRecorded));
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].quantity, kRecorded[i].quantity);
    EXPECT_NEAR(found[i].ours, kRecorded[i].ours, 0.01 * kRecorded[i].ours)
        << found[i].experiment << ", " << found[i].quantity;
  }
}

TEST(AnchorsTest, KatsuragiAndDuriansLawFollowsItsClosedForm) {
  // v^2(z) from their energy equation is zero at the final depth.
  constexpr double k = 1040.0, d = 0.087, g = 9.81;
  for (const double v0 : {0.5, 2.0, 4.0}) {
    const double z = katsuragi_durian(v0).depth_m;
    const double decay = std::exp(-2.0 * z / d);
    const double v2 = v0 * v0 * decay - k * d * z + (g * d + 0.5 * k * d * d) * (1.0 - decay);
    EXPECT_NEAR(v2, 0.0, 2e-3 * v0 * v0) << v0;
  }
}

TEST(AnchorsTest, TheOneFittedNumberIsTheStressOfTheirBall) {
  // Where the cone is full, the force grows by k = 1040/s^2 times the ball's mass per depth.
  const sim::GroundParameters beads = glass_beads();
  const double area = M_PI * 0.0127 * 0.0127;
  EXPECT_NEAR(beads.sigma_cone_npm3 / std::cos(beads.cone_angle_rad) * area, 1040.0 * 0.0692, 1e-6);
  EXPECT_NEAR(beads.packing * beads.grain_density_kgpm3, 1520.0, 1e-9);
}

TEST(AnchorsTest, ABallOnStifferBeadsStopsEarlier) {
  sim::GroundParameters stiff = glass_beads();
  stiff.sigma_flat_npm3 *= 2.0;
  stiff.sigma_cone_npm3 *= 2.0;
  const Stop soft = drop_ball({}, glass_beads(), 2.0), hard = drop_ball({}, stiff, 2.0);
  EXPECT_LT(hard.depth_m, soft.depth_m);
  EXPECT_LT(hard.time_s, soft.time_s);
}

}  // namespace
}  // namespace sandrunner::study
