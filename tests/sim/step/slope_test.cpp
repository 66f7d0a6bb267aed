// SPDX-License-Identifier: BSD-3-Clause
// Ground of any law on slopes and waves: it acts as level ground does to a robot that is turned
// with it, whatever its heading; it never gives energy; friction holds as far as it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/robot/clearance.h"
#include "sim/step/ground_truth.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr GroundKind kAllKinds[] = {GroundKind::kGranular, GroundKind::kRigid, GroundKind::kLinear,
                                    GroundKind::kMud};

Quaternion<double> turn_about(const Vec3<double>& axis, double angle_rad) {
  const double s = std::sin(0.5 * angle_rad);
  return {std::cos(0.5 * angle_rad), s * axis.x, s * axis.y, s * axis.z};
}

Quaternion<double> product(const Quaternion<double>& a, const Quaternion<double>& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

RigidState<double> turned(const RigidState<double>& x, const Quaternion<double>& q) {
  const Mat3<double> r = rotation_matrix(q);
  RigidState<double> t = x;
  t.position = r * x.position;
  t.velocity = r * x.velocity;
  t.orientation = product(q, x.orientation);
  return t;
}

/// From level ground to a slope of this angle that rises towards the heading, ahead going uphill.
Quaternion<double> to_slope(double angle_rad, double heading_rad) {
  return product(turn_about({0, 0, 1}, heading_rad), turn_about({0, 1, 0}, -angle_rad));
}

std::array<double, kNumJoints> trot_torque(const Bench& bench, int step) {
  std::array<double, kNumJoints> torque;
  const double t = step * bench.settings.dt_s;
  for (int j = 0; j < kNumJoints; ++j) {
    const int leg = j / 3;
    const double phase = 15.0 * t + (leg == 0 || leg == 3 ? 0.0 : std::numbers::pi);
    const double swing = j % 3 == 1   ? 0.3 * std::cos(phase)
                         : j % 3 == 2 ? -0.5 * std::fmax(std::sin(phase), 0.0)
                                      : 0.0;
    torque[j] = 80.0 * (bench.robot.nominal_rad[j] + swing - bench.state.rigid.q[j]) -
                1.0 * bench.state.rigid.qd[j];
  }
  return torque;
}

// The laws see place and motion alone, so gravity need not be turned: a robot is led over the slope
// as it went over level ground.
TEST(SlopeTest, LawsActOnASlopeAsOnLevelGroundThatIsTurned) {
  for (const auto& [kind, soles] : {std::pair{GroundKind::kGranular, false},
                                    {GroundKind::kLinear, false},
                                    {GroundKind::kMud, false},
                                    {GroundKind::kGranular, true},
                                    {GroundKind::kLinear, true}}) {
    GroundParameters ground = ground_of_kind(kind);
    ground.coupling_npm = 50.0;
    const Robot robot = soles ? robot_on_soles() : load_raibo();
    Bench level(ground, robot);
    level.state.rigid.velocity = {2.0, 0.5, 0.0};
    const double heading = 0.6, angle = 10.0 * kDegree_rad;
    Bench sloped(ground, robot, slope(angle, heading));
    const Quaternion<double> q = to_slope(angle, heading);
    int ploughing = 0;
    for (int i = 0; i < 6000; ++i) {
      sloped.state.rigid = turned(level.state.rigid, q);
      sloped.step(trot_torque(level, i));
      level.step(trot_torque(level, i));
      for (int l = 0; l < kNumLegs; ++l) {
        ploughing += level.state.feet[l].stroke_latched > 0.0;
        const auto& a = level.report;
        const auto& b = sloped.report;
        ASSERT_NEAR(a.penetration[l], b.penetration[l], 1e-11) << i;
        ASSERT_NEAR(a.raw_force[l], b.raw_force[l], 1e-6) << i;
        ASSERT_NEAR(a.foot_force[l][2], b.foot_force[l][2], 1e-6) << i;
        const FootContact<double>&c = level.state.feet[l], &d = sloped.state.feet[l];
        ASSERT_NEAR(c.memory_depth, d.memory_depth, 1e-11) << i;
        ASSERT_NEAR(c.memory_travel, d.memory_travel, 1e-11) << i;
        ASSERT_NEAR(c.stroke_travel, d.stroke_travel, 1e-11) << i;
        ASSERT_EQ(c.stroke_latched, d.stroke_latched) << i;
      }
    }
    if (kind == GroundKind::kGranular && !soles) {
      EXPECT_GT(ploughing, 100);
    }
  }
}

TEST(SlopeTest, TheHeadingOfTheSlopeDoesNotMatter) {
  for (const GroundKind kind : kAllKinds) {
    const double angle = 10.0 * kDegree_rad;
    Bench along(ground_of_kind(kind), load_raibo(), slope(angle, 0.0));
    const double lowest = lowest_clearance(
        along.robot.model, along.state.rigid.q,
        [&](double x, double y) { return surface_at(along.terrain.shape, x, y).height; });
    along.state.rigid.position.z = 0.002 - lowest;
    along.state.rigid.velocity = {0.5, 0.1, 0.0};
    for (const double heading : {0.7, 2.0, -1.2}) {
      Bench a = along, b(ground_of_kind(kind), load_raibo(), slope(angle, heading));
      const Quaternion<double> q = turn_about({0, 0, 1}, heading);
      b.state.rigid = turned(a.state.rigid, q);
      for (int i = 0; i < 600; ++i) {  // later, rounding has grown
        a.step(trot_torque(a, i));
        b.step(trot_torque(b, i));
      }
      const RigidState<double> expected = turned(a.state.rigid, q);
      const Vec3<double> off = expected.position - b.state.rigid.position;
      EXPECT_LT(std::sqrt(dot(off, off)), 1e-6) << kind_name(kind) << " " << heading;
      for (int j = 0; j < kNumJoints; ++j) {
        EXPECT_NEAR(a.state.rigid.q[j], b.state.rigid.q[j], 1e-6) << kind_name(kind);
      }
    }
  }
}

// A robot whose joints do not move, put on a slope without a jerk.
Bench frozen_on(const GroundParameters& ground, const ShapeParameters& shape) {
  Bench bench(ground, load_raibo(), shape);
  bench.robot.model.rotor_inertia.fill(1e9);
  bench.remove_stops();
  RigidState<double>& x = bench.state.rigid;
  x.position = {0.0, 0.0, 0.001 - lowest_clearance(bench.robot.model, x.q, [](double, double) {
                            return 0.0;
                          })};
  x = turned(x, to_slope(shape.slope_rad, shape.slope_heading_rad));
  return bench;
}

TEST(SlopeTest, GroundNeverGivesEnergy) {
  for (const GroundKind kind : kAllKinds) {
    for (const auto& [roughness, dune_m] : {std::pair{0.0, 0.0}, {0.01, 0.0}, {0.0, 0.3}}) {
      GroundParameters ground = ground_of_kind(kind);
      ground.damping_nspm = 0.0;
      // Energy swings by so much on springs, with steps of dt, more where the normal turns along
      // the way, and in mud, which is elastic for a millimetre.
      const double swing_j = kind == GroundKind::kMud ? 0.1 : dune_m > 0.0 ? 0.05 : 0.03;
      ShapeParameters shape = slope(12.0 * kDegree_rad, 0.4);
      shape.roughness_m = roughness;
      shape.dune_height_m = dune_m;
      shape.dune_length_m = 4.0;
      Bench bench = frozen_on(ground, shape);
      bench.state.rigid.position.z += bench.terrain.shape.crest + 0.02;
      bench.state.rigid.velocity = {0.6, -0.3, 0.0};
      const auto energy = [&] {
        double springs = 0.0;
        Bench probe = bench;  // a step reports the depths at its start
        probe.step({});
        for (const double depth : probe.report.penetration) {
          if (kind == GroundKind::kLinear) springs += std::pow(std::fmax(depth, 0.0), 2);
        }
        return invariants(bench.robot.model, bench.state.rigid).energy_j +
               0.5 * ground.stiffness_npm * springs;
      };
      double least = energy();
      for (int i = 0; i < 4000; ++i) {
        bench.step({});
        if (bench.report.base_contact > 0.0) break;
        if (i % 20 != 0) continue;
        const double now = energy();
        EXPECT_LT(now, least + swing_j)
            << kind_name(kind) << " " << roughness << " " << dune_m << " step " << i;
        least = std::min(least, now);
      }
    }
  }
}

// Downhill acceleration of a robot that has settled, m/s^2.
double slide(const GroundParameters& ground, double slope_rad) {
  Bench bench = frozen_on(ground, slope(slope_rad, 0.9));
  for (int i = 0; i < 12000; ++i) bench.step({});
  const Vec3<double> before = bench.state.rigid.velocity;
  for (int i = 0; i < 2000; ++i) bench.step({});
  const Vec3<double> gained = bench.state.rigid.velocity - before;
  const double c = std::cos(0.9), s = std::sin(0.9);
  return -(gained.x * c + gained.y * s) / std::cos(slope_rad) / 0.5;
}

TEST(SlopeTest, FrictionHoldsUpToItsAngleAndSlidesBeyondAsItSays) {
  constexpr double kFriction = 0.5;
  const double angle = std::atan(kFriction);
  for (const GroundKind kind : {GroundKind::kRigid, GroundKind::kLinear}) {
    GroundParameters ground = ground_of_kind(kind);
    ground.friction = kFriction;
    EXPECT_NEAR(slide(ground, 0.98 * angle), 0.0, 1e-3) << kind_name(kind);
    const double steeper = 1.2 * angle;
    const double expected = kGravity_mps2 * (std::sin(steeper) - kFriction * std::cos(steeper));
    EXPECT_NEAR(slide(ground, steeper), expected, 0.02 * expected) << kind_name(kind);
  }
  GroundParameters sand;
  sand.friction = kFriction;
  EXPECT_NEAR(slide(sand, 0.9 * angle), 0.0, 1e-3);
}

TEST(SlopeTest, StandsAsDeepAsUnderTheNormalPartOfItsWeight) {
  const double angle = 10.0 * kDegree_rad;
  GroundParameters ground = ground_of_kind(GroundKind::kLinear);
  ground.friction = 1.0;
  Bench bench = frozen_on(ground, slope(angle, -2.0));
  for (int i = 0; i < 12000; ++i) bench.step({});
  double depth = 0.0;
  for (const double z : bench.report.penetration) depth += z / kNumLegs;
  const double weight_n = bench.robot.model.mass() * kGravity_mps2;
  EXPECT_NEAR(depth, weight_n * std::cos(angle) / (kNumLegs * ground.stiffness_npm), 1e-6);
  // The truth: heights along the vertical, so the base is as high as on level ground over cos.
  const StateEstimate truth = ground_truth(bench.robot.model, bench.state, bench.terrain);
  Bench level = frozen_on(ground, {});
  const StateEstimate flat = ground_truth(level.robot.model, level.state, level.terrain);
  const double feet = level.robot.model.foot_radius_m;
  EXPECT_NEAR(truth.body_height_m * std::cos(angle), flat.body_height_m - 0.001, 2e-3);
  for (const double height : truth.foot_height_m) {
    EXPECT_NEAR(height * std::cos(angle), feet - depth, 2e-3);
  }
}

TEST(SlopeTest, ARobotThatFallsTouchesTheSlopeWithItsBase) {
  for (const GroundKind kind : kAllKinds) {
    Bench bench(ground_of_kind(kind), load_raibo(), slope(20.0 * kDegree_rad, 0.0));
    RigidState<double>& x = bench.state.rigid;
    x.position = {4.0, 0.0, 4.0 * std::tan(20.0 * kDegree_rad) + 0.4};
    int touched = 0;
    double lowest = 1.0;
    for (int i = 0; i < 4000; ++i) {
      bench.step({});
      touched += bench.report.base_contact > 0.0;
      lowest = std::min(lowest, bench.terrain.shape.over_plane(x.position));
    }
    EXPECT_GT(touched, 100) << kind_name(kind);
    EXPECT_GT(lowest, 0.0) << kind_name(kind);
  }
}

}  // namespace
}  // namespace sandrunner::sim
