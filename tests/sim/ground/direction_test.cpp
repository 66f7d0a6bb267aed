// SPDX-License-Identifier: BSD-3-Clause
// Granular ground that resists by direction and tilt, as resistive force theory has it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/ground/granular_foot.h"

namespace sandrunner::sim {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;

/// Speed of 1 m/s at this angle below the horizontal, towards a heading, of a sole that rises by
/// `beta` towards it.
FootMotion<double> moving(double gamma_rad, double beta_rad, double heading_rad) {
  const double c = std::cos(heading_rad), s = std::sin(heading_rad), rise = std::tan(beta_rad);
  return {.v = std::sin(gamma_rad),
          .vx = std::cos(gamma_rad) * c,
          .vy = std::cos(gamma_rad) * s,
          .tilt_x = rise * c,
          .tilt_y = rise * s};
}

TEST(DirectionTest, TheShareIsThatOfTheGenericCoefficients) {
  // Li, Zhang & Goldman 2013: A00, A10, B11, B01, B-11.
  const auto alpha_z = [](double beta, double gamma) {
    return 0.206 + 0.169 * std::cos(2.0 * beta) + 0.212 * std::sin(2.0 * beta + gamma) +
           0.358 * std::sin(gamma) + 0.055 * std::sin(-2.0 * beta + gamma);
  };
  EXPECT_NEAR(alpha_z(0.0, 0.5 * std::numbers::pi), 1.0, 1e-12);
  double least = 1.0;
  for (int beta = -60; beta <= 60; beta += 10) {
    for (int gamma = 10; gamma <= 90; gamma += 10) {
      const double b = beta * kDegree_rad, g = gamma * kDegree_rad;
      const double expected = std::fmax(alpha_z(b, g), 0.0);
      const double share = share_of_direction(moving(g, b, 0.7));
      EXPECT_NEAR(share, expected, 2e-4) << beta << " " << gamma;
      least = std::fmin(least, share);
    }
  }
  EXPECT_LT(least, 0.2);
}

TEST(DirectionTest, AFootAtRestStandsAsWithout) {
  EXPECT_EQ(share_of_direction(FootMotion<double>{}), 1.0);
  EXPECT_NEAR(share_of_direction(FootMotion<double>{.vx = 5e-4}), 1.0, 2e-3);
}

TEST(DirectionTest, AFootThatIsPushedSidewaysSinksDeeper) {
  double depth_m[2] = {};
  for (const bool direction : {false, true}) {
    GroundParameters ground;
    ground.direction = direction;
    ground.stroke_resistance = ground.healing = false;
    Foot foot(ground);
    constexpr double kMass_kg = 5.0, kSideways_mps = 0.2;
    Point p{.vx = kSideways_mps};
    for (int i = 0; i < 12000; ++i) {
      const double force_n = foot.step(p).normal;
      p.v += (kGravity_mps2 - force_n / kMass_kg) * kDt_s;
      p.v *= 0.9;  // the load comes slowly
      p.x += p.vx * kDt_s;
      p.z += p.v * kDt_s;
    }
    depth_m[direction] = p.z;
  }
  // Its motion is nearly level: alpha_z(0, 0) = 0.375 of the force.
  EXPECT_GT(depth_m[1], 1.5 * depth_m[0]);
}

}  // namespace
}  // namespace sandrunner::sim
