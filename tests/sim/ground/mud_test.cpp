// SPDX-License-Identifier: BSD-3-Clause
// Mud: bearing capacity, suction until the foot breaks off, and that neither gives energy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/sim/ground/granular_foot.h"

namespace sandrunner::sim {
namespace {

using std::numbers::pi;

GroundParameters mud() {
  GroundParameters p;
  p.kind = GroundKind::kMud;
  p.doubling_speed_mps = 0.5;
  p.suction = 1.0;
  return p;
}

/// A disc, so that its area is the same at every depth.
struct Disc : Foot {
  explicit Disc(const GroundParameters& p) : Foot(p) {
    profile = fit_foot_profile(FootShape::kDisc, kFootRadius_m, 0.0, 2.0);
    ground = derive_ground(p, profile, kFootRadius_m);
  }
};
constexpr double kArea_m2 = pi * kFootRadius_m * kFootRadius_m;

double strength(const GroundParameters& p, double z) {
  return p.strength_pa + p.strength_gradient_papm * z;
}

TEST(MudTest, ASlowFootMeetsTheBearingCapacityOfACircularFooting) {
  GroundParameters p = mud();
  p.doubling_speed_mps = 1e3;
  Disc foot(p);
  Point at{0, 0, 0};
  // Skempton 1951: N_c 6 at the surface, 7.2 at a width, 9 from 2.5 widths on.
  for (const auto& [widths, factor] :
       {std::pair{0.1, 6.12}, std::pair{1.0, 7.2}, std::pair{2.5, 9.0}, std::pair{4.0, 9.0}}) {
    const double z = widths * kFootWidth_m;
    const double force = foot.move(at, {0, 0, z}, 4000).normal;
    EXPECT_NEAR(force, factor * strength(p, z) * kArea_m2, 0.02 * force) << widths;
  }
}

TEST(MudTest, StrengthGrowsWithTheRootOfTheSpeed) {
  const GroundParameters p = mud();
  const auto force_at = [&](double speed) {
    Disc foot(p);
    Point at{0, 0, 0};
    return foot.move(at, {0, 0, 0.05}, static_cast<int>(0.05 / speed / kDt_s)).normal;
  };
  const double still = 6.0 * (1.0 + 0.2 * 0.05 / kFootWidth_m) * strength(p, 0.05) * kArea_m2;
  for (const double speed : {0.02, 0.125, 0.5}) {
    EXPECT_NEAR(force_at(speed) / still, 1.0 + std::sqrt(speed / p.doubling_speed_mps), 0.01);
  }
}

TEST(MudTest, HoldsAFootThatRisesAndLetsGoOnce) {
  const GroundParameters p = mud();
  Disc foot(p);
  Point at{0, 0, 0};
  foot.move(at, {0, 0, 0.06}, 1000);
  double least = 0.0, rise_m = 0.0;
  bool free = false;
  for (double z = 0.06; z > -0.01; z -= 0.0005) {
    const double force = foot.move(at, {0, 0, z}, 20).normal;  // 0.1 m/s
    least = std::fmin(least, force);
    if (force < 0.0) {
      EXPECT_FALSE(free) << "held again at " << z;
      rise_m = 0.06 - z;
    }
    if (rise_m > 0.0 && force >= 0.0) free = true;
  }
  const double faster = 1.0 + std::sqrt(0.1 / p.doubling_speed_mps);
  EXPECT_NEAR(least, -7.2 * strength(p, 0.06) * faster * kArea_m2, 0.03 * -least);
  EXPECT_NEAR(rise_m, p.breakoff_widths * kFootWidth_m, 0.001);
}

TEST(MudTest, WithoutSuctionNothingHoldsBack) {
  GroundParameters p = mud();
  p.suction = 0.0;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    Foot foot(p);
    const RandomMotion motion(seed, 0.02, 0.08, 0.1);
    for (int i = 0; i < 4000; ++i) ASSERT_GE(foot.step(motion.at(i * kDt_s)).normal, 0.0);
  }
}

TEST(MudTest, AFootThatStepsIntoItsOwnHoleMeetsItsBottom) {
  // Suction draws the bottom up with the foot, until that breaks off; nothing else does.
  constexpr double kYield_m = 0.001;
  for (const auto& [suction, bottom] :
       {std::pair{0.0, 0.06 - kYield_m}, std::pair{1.0, 0.06 - 0.3 * kFootWidth_m + kYield_m}}) {
    GroundParameters p = mud();
    p.suction = suction;
    Disc foot(p);
    Point at{0, 0, 0};
    foot.move(at, {0, 0, 0.06}, 1000);
    foot.move(at, {0, 0, 0.01}, 1000);
    EXPECT_EQ(foot.move(at, {0, 0, bottom - 0.001}, 1000).normal, 0.0) << suction;
    EXPECT_NEAR(foot.contact.memory_depth, 0.06, 1e-12) << suction;
    EXPECT_GT(foot.move(at, {0, 0, bottom + 0.001}, 100).normal, 0.0) << suction;
  }
}

TEST(MudTest, ResistsSidewaysWithItsStrengthAloneAndNotWithTheLoad) {
  const GroundParameters p = mud();
  Disc foot(p);
  Point at{0, 0, 0};
  const double pressed = foot.move(at, {0, 0, 0.02}, 100).friction_bound;
  const double unloaded = foot.move(at, {0, 0, 0.0199}, 100).friction_bound;
  EXPECT_NEAR(
      pressed,
      strength(p, 0.02) * (kArea_m2 + (3.0 + 0.01 / kFootWidth_m) * pi / 4.0 * kFootWidth_m * 0.02),
      1e-9);
  EXPECT_NEAR(unloaded, pressed, 0.01 * pressed);
}

TEST(MudTest, AFootThatIsLetGoNeverGainsEnergy) {
  // At the ends of the settings' ranges, with the lightest foot of a leg and the longest step.
  for (const double mass_kg : {0.2, 1.0, 10.0}) {
    for (const double dt : {0.25e-3, 0.5e-3}) {
      for (const bool firm : {false, true}) {
        GroundParameters p = mud();
        if (firm) {
          p.strength_pa = 3e4;
          p.strength_gradient_papm = 3e4;
          p.mud_density_kgpm3 = 5000.0;
        }
        Foot foot(p);
        double z = 0.0;
        for (; z < 0.06; z += 1e-5) {
          foot_force(foot.ground, foot.profile, {.z = z, .v = 0.04}, 4000.0, foot.contact);
        }
        // What the foot can have of the mud is what that had stored, below its limit.
        const double yield_m = z - foot.contact.stroke_depth;
        const double limit_n =
            foot_force(foot.ground, foot.profile, {.z = z, .v = 0.0}, 4000.0, foot.contact).normal;
        const double stored_j = 0.5 * limit_n * yield_m;
        double v = 0.0, most_j = 0.0;
        for (int i = 0; i < 4000; ++i) {
          v -= dt *
               foot_force(foot.ground, foot.profile, {.z = z, .v = v}, 1.0 / dt, foot.contact)
                   .normal /
               mass_kg;
          z += dt * v;
          most_j = std::fmax(most_j, 0.5 * mass_kg * v * v);
        }
        EXPECT_LE(most_j, stored_j) << mass_kg << " " << dt << " " << firm;
      }
    }
  }
}

TEST(MudTest, AContactTakesEnergy) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Draw draw(7000 + seed);
    GroundParameters p = mud();
    p.strength_pa = draw(500.0, 3e4);
    p.strength_gradient_papm = draw(0.0, 3e4);
    p.rigidity = draw(50.0, 100.0);
    p.suction = draw(0.0, 1.0);
    Foot foot(p);
    const double mass_kg = draw(1.0, 10.0);
    double z = -draw(0.0, 0.2), v = 0.0, push = 0.0, taken = 0.0;
    bool touching = false;
    for (int i = 0; i < 16000; ++i) {
      if (i % 200 == 0) push = draw(-400.0, 400.0);
      const double force = foot.step({.z = z, .v = v}).normal, before = v;
      v += kDt_s * (kGravity_mps2 + (push - force) / mass_kg);
      z += kDt_s * v;
      taken += force * 0.5 * (before + v) * kDt_s;
      if (touching && z < 0.0) {
        EXPECT_GE(taken, 0.0) << seed;
        taken = 0.0;
        ++contacts;
      }
      touching = z >= 0.0;
    }
  }
  EXPECT_GT(contacts, 50);
}

}  // namespace
}  // namespace sandrunner::sim
