// SPDX-License-Identifier: BSD-3-Clause
// The chapter on the ground: each of its values as recorded, so that a change of the contact law
// that moves one is seen.
#include "tools/study/experiments/anchors.h"

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
      {"final depth, mm", 25.34},
      {"stopping time, ms", 86.5},
      {"final depth, mm", 30.144},
      {"stopping time, ms", 73},
      {"final depth, mm", 41.865},
      {"stopping time, ms", 62.75},
      {"final depth, mm", 54.093},
      {"stopping time, ms", 59},
      {"final depth, mm", 66.251},
      {"stopping time, ms", 56.75},
      {"exponent of the depth over the ball's density", 1.1233},
      {"exponent over its diameter", 0.67563},
      {"exponent over the height of the drop", 0.31948},
      {"stress gained per depth, MN/m\u00b3, loose poppy seeds", 0.4},
      {"stress gained per depth, MN/m\u00b3, close poppy seeds", 0.4},
      {"pressure over depth at 10 mm, MN/m\u00b3", 0.79579},
      {"pressure over depth at 30 mm, MN/m\u00b3", 0.57032},
      {"pressure over depth at 60 mm, MN/m\u00b3", 0.48516},
      {"pressure over depth at 10 mm, MN/m\u00b3", 0.89053},
      {"pressure over depth at 30 mm, MN/m\u00b3", 0.71729},
      {"force at 0.64 m/s over that at 0.04 m/s", 1.0096},
      {"felt from so many widths above it, friction 28 degrees", 1.684},
      {"felt from so many widths above it, friction 30 degrees", 1.830},
      {"felt from so many widths above it, friction 35 degrees", 2.315},
      {"felt from so many widths above it, friction 40 degrees", 3.073},
      {"force over strength and area, 0.1 widths deep", 6.147},
      {"force over strength and area, 0.5 widths deep", 6.630},
      {"force over strength and area, 1 widths deep", 7.232},
      {"force over strength and area, 2 widths deep", 8.438},
      {"force in a tenth of the time; ours: 0.3 m/s over 0.03", 1.155},
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
  const double k = 1040.0, d = 0.087, g = 9.81;
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
