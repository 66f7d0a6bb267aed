// SPDX-License-Identifier: BSD-3-Clause
// The step of the whole robot: standing, joint stops, and that what the report says acts on the
// robot is what acts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/robot/clearance.h"
#include "tests/sim/support.h"
#include "tests/support/csv.h"

namespace sandrunner::sim {
namespace {

std::array<double, kNumJoints> stand_torque(const Bench& bench, double kp, double kd) {
  std::array<double, kNumJoints> torque;
  for (int j = 0; j < kNumJoints; ++j) {
    torque[j] = std::clamp(
        kp * (bench.robot.nominal_rad[j] - bench.state.rigid.q[j]) - kd * bench.state.rigid.qd[j],
        -63.45, 63.45);
  }
  return torque;
}
double vertical_force(const Bench& bench) {
  double sum = 0.0;
  for (const auto& f : bench.report.foot_force) sum += f[2];
  return sum;
}
double weight_n(const Bench& bench) { return bench.robot.model.mass() * kGravity_mps2; }

TEST(StandingTest, RigidGroundCarriesTheWeightWithoutSliding) {
  Bench bench(ground_of_kind(GroundKind::kRigid));
  for (int i = 0; i < 8000; ++i) bench.step(stand_torque(bench, 300.0, 5.0));
  const auto before = bench.report.foot_centre;
  double sum = 0.0;
  for (int i = 0; i < 8000; ++i) {
    bench.step(stand_torque(bench, 300.0, 5.0));
    sum += vertical_force(bench);
    for (int l = 0; l < kNumLegs; ++l)
      EXPECT_GT(bench.report.foot_force[l][2], 0.2 * weight_n(bench));
  }
  EXPECT_NEAR(sum / 8000.0, weight_n(bench), 1e-3 * weight_n(bench));
  for (int l = 0; l < kNumLegs; ++l) {
    const Vec3<double> drift = bench.report.foot_centre[l] - before[l];  // over 2 s
    EXPECT_LT(std::hypot(drift.x, drift.y), 2.0 * 0.1e-3);
    EXPECT_NEAR(bench.report.penetration[l], 0.0, 1e-4);
  }
  // At rest the accelerometer feels gravity only.
  EXPECT_LT(std::sqrt(dot(bench.report.base_acceleration, bench.report.base_acceleration)), 0.01);
  EXPECT_EQ(bench.report.base_contact, 0.0);
  EXPECT_EQ(bench.report.thigh_contact, 0.0);
}

TEST(StandingTest, SpringGroundYieldsByItsStiffness) {
  GroundParameters p = ground_of_kind(GroundKind::kLinear);
  p.stiffness_npm = 20e3;
  Bench bench(p);
  for (int i = 0; i < 16000; ++i) bench.step(stand_torque(bench, 300.0, 5.0));
  double sum = 0.0;
  for (int l = 0; l < kNumLegs; ++l) sum += bench.report.penetration[l] * p.stiffness_npm;
  EXPECT_NEAR(sum, weight_n(bench), 2e-3 * weight_n(bench));
}

TEST(StandingTest, DrySandCarriesTheWeight) {
  // Released at the surface, the robot falls into the sand: a mass on a curve F(z) that gives
  // nothing back comes to rest where int F dz = m g z, 77 mm, twice the static depth for the nearly
  // straight law at (1, 0.2) MN/m^3.
  const GroundParameters sand;
  Bench bench(sand);
  const Ground<double>& ground = bench.terrain.ground[0];
  const auto force = [&](double z) { return quasistatic_force(ground, bench.foot, z); };
  double sudden_m = 0.0, work = 0.0;
  do {
    work += force(sudden_m + 0.5e-5) * 1e-5;
    sudden_m += 1e-5;
  } while (work < 0.25 * weight_n(bench) * sudden_m);
  double mean_force = 0.0;
  for (int i = 0; i < 16000; ++i) {
    bench.step(stand_torque(bench, 300.0, 5.0));
    if (i >= 8000) mean_force += vertical_force(bench) / 8000.0;
  }
  EXPECT_NEAR(mean_force, weight_n(bench), 2e-3 * weight_n(bench));
  for (int l = 0; l < kNumLegs; ++l) {
    EXPECT_GT(bench.report.penetration[l], 0.9 * sudden_m);
    EXPECT_LT(bench.report.penetration[l], 1.02 * sudden_m);
  }
}

TEST(StandingTest, LoweredGentlyItSinksToTheStaticDepth) {
  // All velocities damped by a tenth a step, so that the load comes slowly.
  const double foot_load_n = Bench().robot.model.mass() * kGravity_mps2 / kNumLegs;
  int checked = 0;
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/static_depth.csv")) {
    if (std::fabs(row.at("force_n") - foot_load_n) > 0.01) continue;  // that of another mass
    ++checked;
    GroundParameters p;
    p.sigma_flat_npm3 = 1e6 * row.at("sigma_flat_mnpm3");
    p.sigma_cone_npm3 = 1e6 * row.at("sigma_cone_mnpm3");
    Bench bench(p);
    RigidState<double>& x = bench.state.rigid;
    for (int i = 0; i < 40000; ++i) {
      bench.step(stand_torque(bench, 300.0, 5.0));
      x.velocity = 0.9 * x.velocity;
      x.angular_velocity = 0.9 * x.angular_velocity;
      for (double& qd : x.qd) qd *= 0.9;
    }
    double mean_mm = 0.0;
    for (const double z : bench.report.penetration) mean_mm += 1e3 * z / kNumLegs;
    EXPECT_NEAR(mean_mm, row.at("depth_mm"), 0.05 * row.at("depth_mm"));
  }
  EXPECT_EQ(checked, 2);
}

TEST(StandingTest, UnevenRigidGroundCarriesTheWeight) {
  GroundParameters p = ground_of_kind(GroundKind::kRigid);
  p.friction = 1.0;
  Bench bench(p, load_raibo(), waves(0.01));
  bench.state.rigid.position.z += bench.terrain.shape.crest;
  double sum = 0.0;
  for (int i = 0; i < 16000; ++i) {
    bench.step(stand_torque(bench, 300.0, 5.0));
    if (i < 12000) continue;
    // Contact frame to world: the normal leans by the slope.
    for (int l = 0; l < kNumLegs; ++l) {
      double h, dx, dy;
      const Vec3<double>& c = bench.report.foot_centre[l];
      rough_surface(bench.terrain.shape, c.x, c.y, h, dx, dy);
      const double n = 1.0 / std::sqrt(1.0 + dx * dx + dy * dy), t = 1.0 / std::sqrt(1.0 + dx * dx);
      const auto& f = bench.report.foot_force[l];
      sum += f[2] * n + f[0] * dx * t + f[1] * dy * n * t;
      EXPECT_LT(bench.report.penetration[l], 1e-3);
    }
  }
  EXPECT_NEAR(sum / 4000.0, weight_n(bench), 2e-3 * weight_n(bench));
}

TEST(JointStopTest, HoldAgainstSixtyNewtonMetres) {
  for (int joint = 0; joint < 3; ++joint) {
    for (const double side : {-1.0, 1.0}) {
      Bench bench;
      bench.state.rigid.position.z = 100.0;
      int stopped = 0;
      for (int i = 0; i < 4000; ++i) {
        std::array<double, kNumJoints> torque{};
        for (int l = 0; l < kNumLegs; ++l) torque[3 * l + joint] = 60.0 * side;
        bench.step(torque);
        for (int l = 0; l < kNumLegs; ++l) {
          const int j = 3 * l + joint;
          const double q = bench.state.rigid.q[j];
          ASSERT_LT(q, bench.robot.model.upper_rad[j] + 1e-3);
          ASSERT_GT(q, bench.robot.model.lower_rad[j] - 1e-3);
          const double impulse = bench.state.stop_impulse[j];
          ASSERT_GE(-side * impulse, 0.0);  // it pushes back, it never pulls
          stopped += impulse != 0.0;
        }
      }
      EXPECT_GT(stopped, 4000);
      const int j = joint;
      const double stop =
          side > 0.0 ? bench.robot.model.upper_rad[j] : bench.robot.model.lower_rad[j];
      EXPECT_NEAR(bench.state.rigid.q[j], stop, 1e-3);
      // The reaction is the torque less what still turns the robot.
      EXPECT_NEAR(bench.state.stop_impulse[j] / bench.settings.dt_s, -side * 60.0, 20.0);
    }
  }
}

TEST(JointStopTest, AJointBeyondItsStopIsNotThrownBack) {
  Bench bench;
  bench.state.rigid.position.z = 100.0;
  bench.state.rigid.q[2] = bench.robot.model.upper_rad[2] + 0.1;
  bench.state.rigid.qd[2] = 3.0;
  bench.step({});
  EXPECT_NEAR(bench.state.rigid.qd[2], 0.0, 0.05);  // stopped, without a push to where it should be
  for (int i = 0; i < 200; ++i) bench.step({});
  EXPECT_LT(bench.state.rigid.q[2], bench.robot.model.upper_rad[2] + 0.101);
}

/// Rows of the contact forces in the base's equation: M (v+ - v_free) = J^T lambda.
struct BaseImpulse {
  Vec3<double> linear, angular;  // body components, about the base origin
};
BaseImpulse impulse_on_base(const Bench& bench, const RigidState<double>& before,
                            const std::array<double, kNumJoints>& torque) {
  Dynamics<double> dynamics;
  dynamics.update(bench.robot.model, before);
  const Motion<double> a = dynamics.free_acceleration(torque);
  const Mat3<double> r = rotation_matrix(before.orientation);
  const double dt = bench.settings.dt_s;
  const RigidState<double>& after = bench.state.rigid;
  Motion<double> change;
  change.linear = transposed_times(r, after.velocity - before.velocity) - dt * a.linear;
  change.angular = after.angular_velocity - before.angular_velocity - dt * a.angular;
  for (int j = 0; j < kNumJoints; ++j)
    change.joint[j] = after.qd[j] - before.qd[j] - dt * a.joint[j];
  const std::array<double, 18> v = flat(change);
  const std::array<double, 324> mass = DenseDynamics<double>(dynamics).mass;
  std::array<double, 18> p{};
  for (int i = 0; i < 18; ++i) {
    for (int k = 0; k < 18; ++k) p[i] += mass[18 * i + k] * v[k];
  }
  return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}};
}

TEST(RobotStepTest, ReportedFootForcesAreWhatMovesTheRobot) {
  const std::pair<GroundKind, Robot> cases[] = {{GroundKind::kGranular, load_raibo()},
                                                {GroundKind::kRigid, load_raibo()},
                                                {GroundKind::kLinear, load_raibo()},
                                                {GroundKind::kRigid, robot_on_soles()},
                                                {GroundKind::kLinear, robot_on_soles()}};
  for (const auto& [kind, robot] : cases) {
    Bench bench(ground_of_kind(kind), robot);
    bench.state.rigid.velocity = {2.0, 0.5, 0.0};
    Draw draw(4);
    int checked = 0, ploughing = 0;
    std::array<double, kNumJoints> target = bench.robot.nominal_rad;
    for (int i = 0; i < 2400; ++i) {
      if (i % 80 == 0) {
        for (int j = 0; j < kNumJoints; ++j)
          target[j] = bench.robot.nominal_rad[j] + draw(-0.3, 0.3);
      }
      std::array<double, kNumJoints> torque;
      const RobotState<double> before = bench.state;
      for (int j = 0; j < kNumJoints; ++j)
        torque[j] = 60.0 * (target[j] - before.rigid.q[j]) - 1.0 * before.rigid.qd[j];
      bench.step(torque);
      if (bench.report.base_contact + bench.report.thigh_contact > 0.0) break;
      const BaseImpulse impulse = impulse_on_base(bench, before.rigid, torque);
      const Mat3<double> r = rotation_matrix(before.rigid.orientation);
      Vec3<double> linear{}, angular{};
      double size = 0.0;
      for (int l = 0; l < kNumLegs; ++l) {
        const auto& f = bench.report.foot_force[l];
        const Vec3<double> whole{f[0], f[1], f[2]};
        // Solved contact force at the deepest point; the rest, the stroke resistance, level with
        // the foot's centre and a radius outwards.
        Vec3<double> contact{};
        const double radius = bench.robot.model.foot_radius_m;
        const LegModel<double>& leg = bench.robot.model.legs[l];
        const std::array<double, kNumJoints>& q = before.rigid.q;
        const LegPose<double> pose = leg_pose(leg, q[3 * l], q[3 * l + 1], q[3 * l + 2]);
        int patch = 0;
        for (int k = 0; k < bench.stepper.num_points(); ++k) {
          const PointContact<double>& c = bench.stepper.points()[k];
          if (c.leg != l) continue;
          const Vec3<double> part =
              (1.0 / bench.settings.dt_s) * Vec3<double>{c.impulse[0], c.impulse[1], c.impulse[2]};
          Vec3<double> place;  // of the next patch that is in the ground
          do {
            place = r * hip_to_base(leg, pose, patch_centre(leg, pose, patch++));
          } while (before.rigid.position.z + place.z > radius);
          angular = angular + cross(place - Vec3<double>{0, 0, radius}, part);
          contact = contact + part;
        }
        const Vec3<double> stroke = whole - contact;
        const Vec3<double> centre = bench.report.foot_centre[l] - before.rigid.position;
        const double strength = std::hypot(stroke.x, stroke.y);
        if (strength > 1e-9) {
          ++ploughing;
          angular = angular + cross(centre - (radius / strength) * stroke, stroke);
        }
        linear = linear + whole;
        size += std::sqrt(dot(whole, whole));
      }
      const double dt = bench.settings.dt_s, tolerance = 1e-9 * (1.0 + size * dt);
      const Vec3<double> got = r * impulse.linear, turned = r * impulse.angular;
      ASSERT_NEAR(got.x, linear.x * dt, tolerance);
      ASSERT_NEAR(got.y, linear.y * dt, tolerance);
      ASSERT_NEAR(got.z, linear.z * dt, tolerance);
      ASSERT_NEAR(turned.x, angular.x * dt, tolerance);
      ASSERT_NEAR(turned.y, angular.y * dt, tolerance);
      ASSERT_NEAR(turned.z, angular.z * dt, tolerance);
      checked += size > 0.0;
    }
    EXPECT_GT(checked, 400);
    if (kind == GroundKind::kGranular) {
      EXPECT_GT(ploughing, 5);
    }
  }
}

TEST(RobotStepTest, PatchAtTouchdownHoldsForTheContact) {
  TerrainDescription description = one_patch(ground_of_kind(GroundKind::kLinear));
  description.patches.push_back({10.0, ground_of_kind(GroundKind::kLinear)});
  description.patches[0].ground.stiffness_npm = 20e3;
  description.patches[1].ground.stiffness_npm = 40e3;
  description.patches[0].ground.damping_nspm = description.patches[1].ground.damping_nspm = 0.0;
  Bench bench;
  bench.terrain = make_terrain(description, bench.foot, bench.robot.model);
  RigidState<double>& x = bench.state.rigid;
  const auto touch = [&](double base_x, double depth) {  // places the robot at rest, and steps once
    x = {};
    x.q = bench.robot.nominal_rad;
    x.position = {base_x, 0.0, bench.robot.nominal_height_m - depth};
    bench.step({});
  };
  const auto stiffness = [&](int l) {
    return bench.report.raw_force[l] / bench.report.penetration[l];
  };
  touch(9.6, 0.01);  // front feet at 9.907, hind feet at 9.293
  EXPECT_NEAR(stiffness(0), 20e3, 1.0);
  touch(10.0, 0.01);  // in contact throughout: front feet now at 10.307
  EXPECT_NEAR(stiffness(0), 20e3, 1.0);
  EXPECT_NEAR(stiffness(2), 20e3, 1.0);
  touch(10.0, -0.01);  // lifted, and down again
  touch(10.0, 0.01);
  EXPECT_NEAR(stiffness(0), 40e3, 1.0);
  EXPECT_NEAR(stiffness(2), 20e3, 1.0);
  touch(9.0, 0.01);  // and back, in contact
  EXPECT_NEAR(stiffness(0), 40e3, 1.0);
}

TEST(RobotStepTest, BaseAndKneesAreHardAgainstEveryGround) {
  for (const GroundKind kind : {GroundKind::kGranular, GroundKind::kRigid, GroundKind::kLinear}) {
    Bench bench(ground_of_kind(kind));
    RigidState<double>& x = bench.state.rigid;
    x.q = bench.robot.lying_rad;
    const auto level = [](double, double) { return 0.0; };
    x.position.z = 0.02 - lowest_clearance(bench.robot.model, x.q, level);
    double lowest = 1.0;
    for (int i = 0; i < 8000; ++i) {
      std::array<double, kNumJoints> torque;
      for (int j = 0; j < kNumJoints; ++j) torque[j] = -1.0 * x.qd[j];
      bench.step(torque);
      const Mat3<double> r = rotation_matrix(x.orientation);
      const Vec3<double>&c = bench.robot.model.base_box_centre_m,
            &h = bench.robot.model.base_box_half_m;
      lowest = std::fmin(lowest, x.position.z + dot(r.r2, c) -
                                     (std::fabs(r.r2.x) * h.x + std::fabs(r.r2.y) * h.y +
                                      std::fabs(r.r2.z) * h.z));
    }
    EXPECT_EQ(bench.report.base_contact, 1.0);
    EXPECT_GT(lowest, -2e-3);
    EXPECT_LT(std::sqrt(dot(x.velocity, x.velocity)), 0.02);
  }
}

TEST(RobotStepTest, AThrownRobotLosesEnergyOnly) {
  // Without torques every contact, stop and drag takes energy; what integration errors give back is
  // small beside 150 J.
  const std::pair<GroundKind, Robot> cases[] = {{GroundKind::kGranular, load_raibo()},
                                                {GroundKind::kRigid, load_raibo()},
                                                {GroundKind::kGranular, robot_on_soles()},
                                                {GroundKind::kRigid, robot_on_soles()}};
  for (const auto& [kind, robot] : cases) {
    GroundParameters ground = ground_of_kind(kind);
    ground.direction = robot.model.foot_patches > 1.0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      Bench bench(ground, robot);
      RigidState<double>& x = bench.state.rigid;
      Draw draw(seed);
      x.position.z += 0.1;
      x.velocity = draw.vector(1.0);
      x.angular_velocity = draw.vector(1.5);
      for (double& qd : x.qd) qd = draw(-3.0, 3.0);
      const double start_j = invariants(bench.robot.model, x).energy_j;
      double least_j = start_j, rise_j = 0.0;
      for (int i = 0; i < 4000; ++i) {
        bench.step({});
        const double energy_j = invariants(bench.robot.model, x).energy_j;
        rise_j = std::fmax(rise_j, energy_j - least_j);
        least_j = std::fmin(least_j, energy_j);
      }
      EXPECT_LT(rise_j, 0.1) << seed;
      EXPECT_LT(least_j, 0.5 * start_j) << seed;
    }
  }
}

TEST(RobotStepTest, FloatStaysWithDoubleOverAStride) {
  // 50 ms from the same start; not longer, for contact is chaotic.
  for (const GroundKind kind : {GroundKind::kGranular, GroundKind::kRigid, GroundKind::kLinear}) {
    Bench bench(ground_of_kind(kind));
    bench.state.rigid.velocity = {0.5, 0.0, -0.3};
    const RobotModel<float> model = convert_model<float>(bench.robot.model);
    const FootProfile<float> foot = convert_profile<float>(bench.foot);
    const Terrain<float> terrain = convert_terrain<float>(bench.terrain);
    RobotState<float> state;
    state.rigid = convert<float>(bench.state.rigid);
    RobotStepper<float> stepper;
    StepReport<float> report;
    for (int i = 0; i < 200; ++i) {
      bench.step({});
      stepper.step(model, foot, terrain, {}, {}, state, report);
    }
    EXPECT_NEAR(state.rigid.position.z, bench.state.rigid.position.z, 1e-4);
    EXPECT_NEAR(state.rigid.velocity.z, bench.state.rigid.velocity.z, 5e-3);
    for (int j = 0; j < kNumJoints; ++j)
      EXPECT_NEAR(state.rigid.q[j], bench.state.rigid.q[j], 2e-3);
  }
}

/// A robot in free fall, far from the ground, its joints away from their stops.
Bench falling_robot(double friction_nm) {
  Bench bench;
  bench.state.rigid.position.z = 100.0;
  bench.remove_stops();
  bench.robot.model.friction_nm.fill(friction_nm);
  return bench;
}

TEST(JointFrictionTest, OfAJointThatMovesIsATorqueAgainstItsMotion) {
  Bench rubs = falling_robot(0.4), pulled = falling_robot(0.0);
  JointArray<double> torque_nm{}, less_nm{};
  for (int j = 0; j < kNumJoints; ++j) {
    const double way = j % 2 == 0 ? 1.0 : -1.0;
    rubs.state.rigid.qd[j] = pulled.state.rigid.qd[j] = 5.0 * way;
    torque_nm[j] = 1.0 * way;
    less_nm[j] = 0.6 * way;
  }
  for (int i = 0; i < 100; ++i) {
    rubs.step(torque_nm);
    pulled.step(less_nm);
  }
  for (int j = 0; j < kNumJoints; ++j) {
    ASSERT_GT(std::fabs(rubs.state.rigid.qd[j]), kFrictionSpeed_radps);
    EXPECT_NEAR(rubs.state.rigid.qd[j], pulled.state.rigid.qd[j], 1e-9) << j;
  }
}

TEST(JointFrictionTest, HoldsAJointWhoseTorqueIsSmaller) {
  Bench held = falling_robot(0.4), free = falling_robot(0.0);
  JointArray<double> torque_nm{};
  for (int j = 2; j < kNumJoints; j += kJointsPerLeg) torque_nm[j] = 0.3;
  for (int i = 0; i < 400; ++i) {
    held.step(torque_nm);
    free.step(torque_nm);
  }
  for (int j = 2; j < kNumJoints; j += kJointsPerLeg) {
    EXPECT_LT(std::fabs(held.state.rigid.qd[j]), kFrictionSpeed_radps) << j;
    EXPECT_GT(std::fabs(free.state.rigid.qd[j]), 5.0 * kFrictionSpeed_radps) << j;
  }
}

}  // namespace
}  // namespace sandrunner::sim
