// SPDX-License-Identifier: BSD-3-Clause
// Properties of the granular law that any motion of the foot must show, and what each switch takes
// away.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/sim/ground/granular_foot.h"
#include "tests/support/csv.h"

namespace sandrunner::sim {
namespace {

TEST(GranularTest, RawForceIsZeroWhenTheFootRisesAndFilteredForceIsNeverNegative) {
  int rising = 0, decelerating = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Draw draw(2000 + seed);
    Foot foot(random_ground(draw));
    const RandomMotion motion(seed, 0.02, 0.08, 0.1);
    for (int i = 0; i < 4000; ++i) {
      Point q = motion.at(i * kDt_s);
      // Vibration of a fifth of a millimetre on top, as of a leg that rings.
      q.z += 2e-4 * std::sin(2500.0 * i * kDt_s);
      q.v += 0.5 * std::cos(2500.0 * i * kDt_s);
      const FootForce<double> f = foot.step(q);
      if (q.v <= 0.0) {
        ASSERT_EQ(f.raw, 0.0);
        ++rising;
      }
      if (q.z < 0.0) {
        ASSERT_EQ(f.normal, 0.0);
        ASSERT_EQ(f.friction_bound, 0.0);
        ASSERT_EQ(f.stroke, 0.0);
      }
      ASSERT_GE(f.normal, 0.0);
      ASSERT_GE(f.friction_bound, 0.0);
      ASSERT_GE(f.stroke, 0.0);
      decelerating += f.raw < 0.0;
    }
  }
  EXPECT_GT(rising, 50000);
  EXPECT_GT(decelerating,
            0);  // the added mass can make the raw force negative: the clamp is needed
}

/// Work of the vertical ground force on a mass over each contact, J. The mass is also pushed up and
/// down at random.
std::vector<double> work_of_contacts(const GroundParameters& p, std::uint64_t seed, double mass_kg,
                                     double push_n) {
  Foot foot(p);
  Draw draw(seed);
  std::vector<double> work;
  double z = -draw(0.0, 0.2), v = 0.0, push = 0.0, sum = 0.0;
  bool touching = false;
  for (int i = 0; i < 16000; ++i) {
    if (i % 200 == 0) push = draw(-push_n, push_n);
    const double force = foot.step({0.0, 0.0, z, 0.0, 0.0, v}).normal;
    const double before = v;
    v += kDt_s * (kGravity_mps2 + (push - force) / mass_kg);
    z += kDt_s * v;
    // Over a step the force acts at the mean of both velocities: that is what the kinetic energy
    // gains.
    sum -= force * 0.5 * (before + v) * kDt_s;
    if (touching && z < 0.0) {
      work.push_back(sum);
      sum = 0.0;
    }
    touching = z >= 0.0;
  }
  if (touching) work.push_back(sum);
  return work;
}

TEST(GranularTest, WorkOfAContactIsNeverPositive) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Draw draw(3000 + seed);
    GroundParameters p;
    p.sigma_flat_npm3 = draw(0.5e6, 10e6);
    p.sigma_cone_npm3 = draw(0.1e6, 0.6e6);
    for (const double work : work_of_contacts(p, seed, draw(2.0, 10.0), draw(0.0, 400.0))) {
      EXPECT_LE(work, 0.0) << seed;
      ++contacts;
    }
  }
  EXPECT_GT(contacts, 500);
}

TEST(GranularTest, SecondPressToLessThanTheRememberedDepthGivesNoForce) {
  Foot foot({});
  Point at{0, 0, -0.001};
  EXPECT_GT(foot.move(at, {0, 0, 0.05}, 400).raw, 0.0);
  foot.move(at, {0, 0, 0.01}, 400);
  for (int i = 0; i < 40; ++i) {  // down again, to within the plastic tolerance of 0.1 mm
    EXPECT_EQ(foot.move(at, {0, 0, 0.01 + i * 0.00099}, 5).raw, 0.0) << at.z;
  }
  EXPECT_EQ(foot.move(at, {0, 0, 0.04985}, 5).raw, 0.0);
  EXPECT_GT(foot.move(at, {0, 0, 0.04995}, 5).raw, 0.0);
  EXPECT_NEAR(foot.contact.memory_depth, 0.05, 1e-9);
}

TEST(GranularTest, FrictionBoundFollowsTheQuasistaticForceOnly) {
  GroundParameters p;
  p.friction = 0.6;
  for (const bool gated : {false, true}) {
    p.gated_friction = gated;
    Foot foot(p);
    Point at{0, 0, -0.01};
    FootForce<double> f = foot.move(at, {0, 0, 0.02}, 100);  // 0.3 mm a step: fast
    EXPECT_NEAR(f.friction_bound, 0.6 * foot.quasistatic(at.z), 1e-9);
    EXPECT_GT(f.raw, foot.quasistatic(at.z));  // drag is there, and not in the bound
    f = foot.move(at, {0, 0, 0.01}, 100);
    EXPECT_NEAR(f.friction_bound, gated ? 0.0 : 0.6 * foot.quasistatic(at.z), 1e-9);
    f = foot.move(at, {0, 0, 0.015}, 100);  // down again, above the remembered depth
    EXPECT_NEAR(f.friction_bound, gated ? 0.0 : 0.6 * foot.quasistatic(at.z), 1e-9);
  }
}

TEST(GranularTest, StrokeResistanceActsOutwardsIntoFreshGroundWhenBuried) {
  const GroundParameters p;
  Foot foot(p);
  Point at{0, 0, -0.001};
  foot.move(at, {0, 0, 0.06}, 400);
  EXPECT_EQ(foot.move(at, {0.0499, 0, 0.06}, 200).stroke, 0.0);  // within the crater
  FootForce<double> f = foot.move(at, {0.07, 0, 0.06}, 200);
  EXPECT_EQ(f.direction_x, 1.0);
  // The crater was latched where healing begins: eq. 1 with d = 70 mm at the remembered depth, then
  // eq. 2.
  const double angle = p.crater_angle_rad;
  const double overlap =
      0.07 + kFootRadius_m / std::sin(angle) - 0.05 - kFootRadius_m / std::tan(angle);
  EXPECT_NEAR(f.stroke, 160.0 * (overlap + 0.5 * (0.06 - kFootRadius_m)) + 1.0 * at.vx, 1e-6);
  EXPECT_EQ(foot.move(at, {0.06, 0, 0.06}, 50).stroke, 0.0);  // back: nothing
  EXPECT_EQ(foot.move(at, {0.069, 0, 0.06}, 50).stroke,
            0.0);  // outwards, but not into fresh ground
  EXPECT_GT(foot.move(at, {0.08, 0, 0.06}, 50).stroke, 0.0);
  // Risen to less than a foot radius deep: not buried.
  foot.move(at, {0.08, 0, 0.0290}, 50);
  EXPECT_EQ(foot.move(at, {0.10, 0, 0.0290}, 50).stroke, 0.0);
}

TEST(GranularTest, HealingLetsTheFootClimbOutOfItsCrater) {
  GroundParameters p;
  p.stroke_resistance = false;
  for (const bool healing : {true, false}) {
    p.healing = healing;
    Foot foot(p);
    Point at{0, 0, -0.001};
    foot.move(at, {0, 0, 0.05}, 400);
    foot.move(at, {0, 0, 0.03}, 200);
    foot.move(at, {0.049, 0, 0.03}, 200);
    EXPECT_NEAR(foot.contact.memory_depth, 0.05, 1e-9);  // within the crater's floor nothing heals
    foot.move(at, {0.065, 0, 0.03}, 200);
    // 15 mm beyond the floor's radius, wall at 45 degrees.
    EXPECT_NEAR(foot.contact.memory_depth, healing ? 0.035 : 0.05, 1e-9);
    EXPECT_EQ(foot.move(at, {0.065, 0, 0.0345}, 10).raw, 0.0);
    const double raw = foot.move(at, {0.065, 0, 0.036}, 10).raw;
    if (healing) {
      EXPECT_GT(raw, 0.0);
    } else {
      EXPECT_EQ(raw, 0.0);
    }
  }
}

TEST(GranularTest, TouchdownForgetsTheLastContact) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Foot used({}), fresh({});
    const RandomMotion before(seed, 0.05, 0.05, 0.1), after(seed + 500, 0.03, 0.06, 0.1);
    for (int i = 0; i < 2000; ++i) used.step(before.at(i * kDt_s));
    // In the air: only the velocity, for the acceleration, is kept.
    const Point air{0.0, 0.0, -0.01, 0.0, 0.0, 0.3};
    used.step(air);
    fresh.step(air);
    for (int i = 0; i < 2000; ++i) {
      const Point q = after.at(i * kDt_s);
      const FootForce<double> a = used.step(q), b = fresh.step(q);
      ASSERT_EQ(a.raw, b.raw);
      ASSERT_EQ(a.normal, b.normal);
      ASSERT_EQ(a.friction_bound, b.friction_bound);
      ASSERT_EQ(a.stroke, b.stroke);
    }
  }
}

TEST(GranularTest, EachSwitchTakesItsOwnEffectAway) {
  const auto force_at = [](const GroundParameters& p, double speed_mps, double acceleration_mps2) {
    Foot foot(p);
    foot.step({0, 0, 0.0199, 0, 0, speed_mps - acceleration_mps2 * kDt_s});
    return foot.step({0, 0, 0.02, 0, 0, speed_mps}).raw;
  };
  GroundParameters p;
  const Foot foot(p);
  const double quasistatic = foot.quasistatic(0.02);
  CsvRow tyre;  // at 20 mm
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/cone.csv")) {
    if (row.at("constant_radius_m") == 0.0 && row.at("z_m") == 0.02) tyre = row;
  }
  const double drag = tyre.at("drag_ns2pm2"), mass = tyre.at("added_mass_kg");
  EXPECT_NEAR(force_at(p, 1.0, 50.0), quasistatic + drag + mass * 50.0, 1e-3);
  p.inertial_drag = false;
  EXPECT_NEAR(force_at(p, 1.0, 50.0), quasistatic + mass * 50.0, 1e-3);
  p.added_mass = false;
  EXPECT_NEAR(force_at(p, 1.0, 50.0), quasistatic, 1e-9);

  // No memory: a second press meets the same ground again.
  p = {};
  p.plastic_memory = false;
  Foot elastic(p);
  Point at{0, 0, -0.001};
  elastic.move(at, {0, 0, 0.05}, 400);
  elastic.move(at, {0, 0, 0.01}, 400);
  EXPECT_GT(elastic.move(at, {0, 0, 0.02}, 50).raw, 0.0);

  // No filter: the force is the raw one, whatever reversals came before.
  p = {};
  p.filter = false;
  Foot unfiltered(p);
  const RandomMotion shaking(3, 0.05, 0.02, 0.0);
  for (int i = 0; i < 4000; ++i) {
    const FootForce<double> f = unfiltered.step(shaking.at(i * kDt_s));
    ASSERT_EQ(f.normal, std::fmax(f.raw, 0.0));
  }

  // No stroke resistance: ploughing is free.
  p = {};
  p.stroke_resistance = false;
  Foot smooth(p);
  at = {0, 0, -0.001};
  smooth.move(at, {0, 0, 0.06}, 400);
  EXPECT_EQ(smooth.move(at, {0.2, 0, 0.06}, 400).stroke, 0.0);
}

TEST(GranularTest, FilterGrowsByOneFortiethAReversal) {
  Foot foot({});
  double v = 0.1;
  for (int reversal = 0; reversal <= 60; ++reversal, v = -v) {
    foot.step({0, 0, 0.02, 0, 0, v});
    EXPECT_NEAR(foot.contact.filter, std::fmin(1.0, 0.025 * reversal), 1e-12);
    foot.step({0, 0, 0.02, 0, 0, v});  // no reversal: no growth
    EXPECT_NEAR(foot.contact.filter, std::fmin(1.0, 0.025 * reversal), 1e-12);
  }
  // At its longest the memory is 0.8: a constant raw force is reached geometrically, 0.2 of the
  // rest a step.
  Foot still = foot;
  for (int i = 0; i < 200; ++i) still.step({0, 0, 0.02, 0, 0, -0.1});
  EXPECT_LT(still.contact.force, 1e-12);
  double expected = still.contact.force;
  for (int i = 0; i < 10; ++i) {
    const FootForce<double> f = still.step({0, 0, 0.021, 0, 0, 0.1});
    expected += 0.2 * (f.raw - expected);
    if (i == 0) continue;  // the reversal itself
    EXPECT_NEAR(f.normal, expected, 1e-9 * expected);
  }
}

}  // namespace
}  // namespace sandrunner::sim
