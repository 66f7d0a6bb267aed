// SPDX-License-Identifier: BSD-3-Clause
// Springs under the feet, alone and with a pressure that the feet share.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/step/ground_truth.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

GroundParameters springs(double stiffness_npm, double coupling_npm, double damping_nspm) {
  GroundParameters p = ground_of_kind(GroundKind::kLinear);
  p.stiffness_npm = stiffness_npm;
  p.coupling_npm = coupling_npm;
  p.damping_nspm = damping_nspm;
  return p;
}

/// A robot whose joints do not move, on frictionless springs.
struct Table {
  explicit Table(GroundParameters p) : bench((p.friction = 0.0, p)), ground(p) {
    bench.robot.model.rotor_inertia.fill(1e9);
    bench.remove_stops();
    Bench probe = bench;
    probe.step({});
    surface_m = bench.state.rigid.position.z + probe.report.penetration[0];
    mass_kg = bench.robot.model.mass();
  }
  void put(double depth_m) { bench.state.rigid.position.z = surface_m - depth_m; }
  double depth() const { return surface_m - bench.state.rigid.position.z; }
  double stiffness() const {
    return kNumLegs * (ground.stiffness_npm + kNumLegs * ground.coupling_npm);
  }
  double static_depth() const { return mass_kg * kGravity_mps2 / stiffness(); }
  double spring_energy() const {
    double sum = 0.0, squares = 0.0;
    for (const double z : depths()) {
      sum += z;
      squares += z * z;
    }
    return 0.5 * (ground.stiffness_npm * squares + ground.coupling_npm * sum * sum);
  }
  std::array<double, kNumLegs> depths() const {
    Bench probe = bench;  // a step reports the depths at its start
    probe.step({});
    std::array<double, kNumLegs> depths;
    for (int l = 0; l < kNumLegs; ++l) depths[l] = std::max(probe.report.penetration[l], 0.0);
    return depths;
  }
  double energy() const {
    return invariants(bench.robot.model, bench.state.rigid).energy_j + spring_energy();
  }

  Bench bench;
  GroundParameters ground;
  double surface_m = 0.0, mass_kg = 0.0;
};

TEST(SpringGroundTest, AHeavingRobotHasTheFrequencyAndDampingOfItsMassOnTheSprings) {
  for (const auto& p : {springs(10e3, 0.0, 0.0), springs(10e3, 0.0, 100.0),
                        springs(750.0, 170.0, 60.0), springs(900.0, 0.0, 360.0)}) {
    Table table(p);
    Sym3<double>& inertia = table.bench.robot.model.base.inertia;
    inertia.xx = inertia.yy = inertia.zz = 1e6;  // heaves and does not pitch
    const double size = 0.2 * table.static_depth();
    table.put(table.static_depth() + size);
    const double omega = std::sqrt(table.stiffness() / table.mass_kg);
    const double decay = 0.5 * kNumLegs * p.damping_nspm / table.mass_kg;
    const double square = omega * omega - decay * decay;
    const double root = std::sqrt(std::fabs(square));
    double worst = 0.0, t = 0.0;
    while (t < 3.0 * 2.0 * std::numbers::pi / omega) {
      table.bench.step({});
      t += table.bench.settings.dt_s;
      const double even = square > 0.0 ? std::cos(root * t) : std::cosh(root * t);
      const double odd = square > 0.0 ? std::sin(root * t) : std::sinh(root * t);
      const double expected = size * std::exp(-decay * t) * (even + decay / root * odd);
      worst = std::max(worst, std::fabs(table.depth() - table.static_depth() - expected) / size);
    }
    EXPECT_LT(worst, 0.01) << p.stiffness_npm << " " << p.coupling_npm << " " << p.damping_nspm;
  }
}

TEST(SpringGroundTest, ForcesAreTheGradientOfOneEnergy) {
  const GroundParameters p = springs(750.0, 170.0, 0.0);
  Table table(p);
  Draw draw(1);
  for (int i = 0; i < 20; ++i) {
    table.put(draw(0.0, 0.08));
    table.bench.state.rigid.orientation = integrate(Quaternion<double>{}, draw.vector(0.1));
    const std::array<double, kNumLegs> depths = table.depths();
    double sum = 0.0;
    for (const double z : depths) sum += z;
    Bench probe = table.bench;
    probe.step({});
    for (int l = 0; l < kNumLegs; ++l) {
      const double force =
          depths[l] > 0.0 ? p.stiffness_npm * depths[l] + p.coupling_npm * sum : 0.0;
      EXPECT_NEAR(probe.report.foot_force[l][2], force, 1e-9 * p.stiffness_npm);
    }
  }
}

TEST(SpringGroundTest, PressingOneFootRaisesTheOthers) {
  const auto front_force = [](double coupling_npm, double pitch_rad) {
    Table table(springs(750.0, coupling_npm, 0.0));
    table.put(0.05);
    table.bench.state.rigid.orientation =
        integrate(Quaternion<double>{}, Vec3<double>{0.0, pitch_rad, 0.0});
    table.bench.step({});
    // Per depth of its own.
    return table.bench.report.foot_force[0][2] / table.bench.report.penetration[0];
  };
  // Hind feet that go deeper press the front feet up, and only through the pressure.
  EXPECT_NEAR(front_force(0.0, -0.05), front_force(0.0, 0.0), 1e-9);
  EXPECT_GT(front_force(170.0, -0.05), 1.05 * front_force(170.0, 0.0));
}

TEST(SpringGroundTest, AClosedCycleWithoutDampingDoesNoWork) {
  Table table(springs(750.0, 170.0, 0.0));
  constexpr int kSteps = 2000;
  double work = 0.0, moved = 0.0;
  std::array<double, kNumLegs> depth_before{}, force_before{};
  for (int i = 0; i <= kSteps; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / kSteps;
    table.put(0.05 + 0.04 * std::sin(phase));
    table.bench.state.rigid.orientation =
        integrate(Quaternion<double>{},
                  Vec3<double>{0.1 * std::cos(phase), 0.1 * std::sin(2.0 * phase), 0.0});
    Bench probe = table.bench;
    probe.step({});
    for (int l = 0; l < kNumLegs; ++l) {
      const double depth = std::max(probe.report.penetration[l], 0.0);
      const double force = probe.report.foot_force[l][2];
      if (i > 0) {
        const double step = 0.5 * (force + force_before[l]) * (depth - depth_before[l]);
        work += step;
        moved += std::fabs(step);
      }
      depth_before[l] = depth;
      force_before[l] = force;
    }
  }
  EXPECT_GT(moved, 5.0);
  EXPECT_LT(std::fabs(work), 1e-3 * moved);
}

TEST(SpringGroundTest, ABouncingRobotGainsNoEnergy) {
  constexpr double kDrop_m = 0.02;
  for (const auto& p : {springs(10e3, 0.0, 0.0), springs(750.0, 170.0, 0.0),
                        springs(750.0, 170.0, 60.0), springs(900.0, 0.0, 360.0)}) {
    Table table(p);
    table.put(-kDrop_m);
    table.bench.state.rigid.orientation =
        integrate(Quaternion<double>{}, Vec3<double>{0.02, 0.03, 0.0});
    const double start = table.energy();
    const double available = table.mass_kg * kGravity_mps2 * kDrop_m;
    double most = 0.0, touched = 0.0;
    for (int i = 0; i < 4000; ++i) {
      table.bench.step({});
      touched += table.bench.report.base_contact + table.bench.report.thigh_contact;
      if (i % 20 == 0) most = std::max(most, table.energy() - start);
    }
    EXPECT_LT(most, 0.01 * available) << p.stiffness_npm;
    EXPECT_EQ(touched, 0.0);
    const double lost = (start - table.energy()) / available;
    if (p.damping_nspm == 0.0) {
      EXPECT_LT(lost, 0.02) << p.stiffness_npm;
    } else {
      EXPECT_GT(lost, 0.1) << p.stiffness_npm;
    }
  }
}

// The light feet of free legs meet the largest damping that a training draws, at its time step.
TEST(SpringGroundTest, TheStiffestDampedSpringsOfATrainingGiveALimpRobotNoEnergy) {
  for (const double ratio : {0.1, 1.0}) {
    const double quarter_kg = load_raibo().model.mass() / kNumLegs;
    Table table(springs(33e3, 0.0, 2.0 * ratio * std::sqrt(33e3 * quarter_kg)));
    table.bench.robot = load_raibo();
    table.bench.remove_stops();
    table.bench.settings.dt_s = 0.5e-3;
    table.put(-0.02);
    table.bench.state.rigid.velocity.z = -1.0;
    const double start = table.energy();
    double most = 0.0, deepest = 0.0;
    for (int i = 0; i < 300; ++i) {
      table.bench.step({});
      deepest = std::max(deepest, table.bench.report.penetration[0]);
      most = std::max(most, table.energy() - start);
    }
    EXPECT_LT(most, 0.005 * 0.5 * table.mass_kg) << ratio;
    EXPECT_GT(deepest, 1e-4) << ratio;
  }
}

TEST(SpringGroundTest, BodyHeightCountsThePresentDepthOfSprings) {
  Table table(springs(750.0, 170.0, 0.0));
  for (const double depth : {0.05, 0.09, 0.03}) {  // pressed deeper and released again
    table.put(depth);
    table.bench.state.rigid.velocity = {};
    Bench probe = table.bench;
    probe.step({});
    table.bench.state.feet = probe.state.feet;
    const StateEstimate truth =
        ground_truth(table.bench.robot.model, table.bench.state, table.bench.terrain);
    EXPECT_NEAR(truth.body_height_m, table.surface_m, 1e-9);
  }
}

}  // namespace
}  // namespace sandrunner::sim
