// SPDX-License-Identifier: BSD-3-Clause
// Feet of several patches: together they bear what a foot of their area bears, and a moment.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/support.h"
#include "tests/support/error_of.h"

namespace sandrunner::sim {
namespace {

constexpr double kLength_m = 0.1, kWidth_m = 0.08;

// Where the patches are from the foot's centre, with the robot's base level, m.
std::vector<Vec3<double>> patches_of(const Robot& robot, const JointArray<double>& q, int l) {
  const LegModel<double>& leg = robot.model.legs[l];
  const LegPose<double> pose = leg_pose(leg, q[3 * l], q[3 * l + 1], q[3 * l + 2]);
  std::vector<Vec3<double>> places;
  for (int i = 0; i < static_cast<int>(robot.model.foot_patches); ++i) {
    places.push_back(hip_to_base(leg, pose, patch_centre(leg, pose, i)) -
                     hip_to_base(leg, pose, pose.foot));
  }
  return places;
}

// Lowers the left front foot's centre until its sole is as deep, m.
void put_at_depth(Bench& bench, double depth_m) {
  const LegModel<double>& leg = bench.robot.model.legs[0];
  const JointArray<double>& q = bench.state.rigid.q;
  const LegPose<double> pose = leg_pose(leg, q[0], q[1], q[2]);
  bench.state.rigid.position.z =
      bench.robot.model.foot_radius_m - depth_m - hip_to_base(leg, pose, pose.foot).z;
}

TEST(FlatFeetTest, ABoxOfTheUrdfIsASoleOfFourPatches) {
  const Robot robot = robot_on_soles();
  EXPECT_EQ(robot.model.foot_length_m, kLength_m);
  EXPECT_EQ(robot.model.foot_width_m, kWidth_m);
  EXPECT_EQ(robot.model.foot_radius_m, 0.01);
  for (int l = 0; l < kNumLegs; ++l) {
    const auto places = patches_of(robot, robot.nominal_rad, l);
    ASSERT_EQ(places.size(), 4u);
    double along = 0.0, across = 0.0;
    for (const Vec3<double>& p : places) {
      EXPECT_NEAR(p.z, 0.0, 1e-7);  // level as it stands
      along += p.x * p.x / 4.0;
      across += p.y * p.y / 4.0;
    }
    // Second moments of the sole's area, over its area.
    EXPECT_NEAR(along, kLength_m * kLength_m / 12.0, 1e-9);
    EXPECT_NEAR(across, kWidth_m * kWidth_m / 12.0, 1e-9);
  }
}

TEST(FlatFeetTest, ARobotsFileMayAskForFewerOrMore) {
  EXPECT_EQ(robot_on_soles("foot_patches = 1\n").model.foot_patches, 1.0);
  EXPECT_EQ(load_raibo().model.foot_patches, 1.0);
  const auto raibo = [](const std::string& more) {
    return parse_robot(edited(std::string(embedded_robot_file("raibo.toml")), "", "[collision]\n",
                              "[collision]\n" + more),
                       "r.toml", std::string(embedded_robot_file("raibo.urdf")), "r.urdf");
  };
  const Robot on_edges = raibo("foot_patches = 2\n");
  const auto places = patches_of(on_edges, on_edges.nominal_rad, 0);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR(places[0].y - places[1].y, 0.025 / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(error_of([] { robot_on_soles("foot_patches = 2\n"); }),
            "soles.toml: collision.foot_patches: found 2, expected 1 or 4 of the box of link "
            "'LF_FOOT'");
  EXPECT_EQ(error_of([&] { raibo("foot_patches = 4\n"); }),
            "r.toml: collision.foot_patches: found 4, expected 1 or 2 of the cylinder of link "
            "'LF_FOOT'");
  EXPECT_EQ(error_of([&] { raibo("foot_radius_m = 0.03\nfoot_patches = 2\n"); }),
            "r.toml: collision.foot_patches: found 2, expected 1 of the ball of link 'LF_FOOT'");
}

TEST(FlatFeetTest, LevelItBearsWhatOnePointOfItsAreaBears) {
  for (const GroundKind kind : {GroundKind::kGranular, GroundKind::kLinear, GroundKind::kMud}) {
    GroundParameters ground = ground_of_kind(kind);
    ground.coupling_npm = 500.0;
    Bench four(ground, robot_on_soles()), one(ground, robot_on_soles("foot_patches = 1\n"));
    for (Bench* bench : {&four, &one}) {
      bench->state.rigid.position.z -= 0.004;
      bench->state.rigid.velocity.z = -0.1;
      bench->step({});
    }
    for (int l = 0; l < kNumLegs; ++l) {
      EXPECT_NEAR(four.report.penetration[l], 0.004, 1e-6) << kind_name(kind);
      const double force_n = one.report.foot_force[l][2];
      EXPECT_GT(force_n, 10.0) << kind_name(kind);
      EXPECT_NEAR(four.report.foot_force[l][2], force_n, 1e-4 * force_n) << kind_name(kind);
      EXPECT_NEAR(four.report.raw_force[l], one.report.raw_force[l], 1e-4 * force_n);
    }
  }
}

TEST(FlatFeetTest, AtAnAngleItBearsTheMomentOfTheWholeSole) {
  GroundParameters ground = ground_of_kind(GroundKind::kLinear);
  ground.damping_nspm = 0.0;
  ground.coupling_npm = 0.0;
  Bench bench(ground, robot_on_soles());
  const double angle = 0.1, depth_m = 0.02;
  RigidState<double>& x = bench.state.rigid;
  x.q[2] += angle;  // of the left front knee: that foot turns forwards
  put_at_depth(bench, depth_m);
  bench.step({});
  const auto places = patches_of(bench.robot, bench.robot.nominal_rad, 0);
  double force_n = 0.0, moment_nm = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const PointContact<double>& c = bench.stepper.points()[i];
    ASSERT_EQ(c.leg, 0);
    const double normal_n = c.impulse[2] / bench.settings.dt_s;
    force_n += normal_n;
    moment_nm += normal_n * places[i].x * std::cos(angle);
  }
  EXPECT_NEAR(force_n, ground.stiffness_npm * depth_m, 1e-6 * force_n);
  const double expected_nm =
      ground.stiffness_npm * std::sin(angle) * std::cos(angle) * kLength_m * kLength_m / 12.0;
  EXPECT_NEAR(moment_nm, expected_nm, 1e-6 * expected_nm);
}

TEST(FlatFeetTest, ASoleThatRisesAlongItsMotionIsBorneBetter) {
  GroundParameters ground;
  ground.direction = true;
  ground.added_mass = ground.inertial_drag = false;
  double force_n[2] = {};
  for (const bool toes_up : {false, true}) {
    Bench bench(ground, robot_on_soles());
    RigidState<double>& x = bench.state.rigid;
    const double angle = toes_up ? -0.1 : 0.1;
    for (int l = 0; l < kNumLegs; ++l) x.q[3 * l + 2] += angle;
    put_at_depth(bench, 0.012);
    x.velocity = {0.5, 0.0, -0.1};
    bench.step({});
    force_n[toes_up] = 0.0;
    for (const double raw_n : bench.report.raw_force) force_n[toes_up] += raw_n;
  }
  EXPECT_GT(force_n[1], 1.05 * force_n[0]);
}

TEST(FlatFeetTest, StandsOnHardGroundWithoutSliding) {
  Bench bench(ground_of_kind(GroundKind::kRigid), robot_on_soles());
  const double weight_n = bench.robot.model.mass() * kGravity_mps2;
  int most_sweeps = 0;
  const auto hold = [&] {
    std::array<double, kNumJoints> torque;
    for (int j = 0; j < kNumJoints; ++j) {
      torque[j] = 300.0 * (bench.robot.nominal_rad[j] - bench.state.rigid.q[j]) -
                  5.0 * bench.state.rigid.qd[j];
    }
    bench.step(torque);
  };
  for (int i = 0; i < 8000; ++i) hold();
  const auto before = bench.report.foot_centre;
  double sum_n = 0.0;
  for (int i = 0; i < 8000; ++i) {
    hold();
    for (const auto& f : bench.report.foot_force) sum_n += f[2] / 8000.0;
    most_sweeps = std::max(most_sweeps, bench.report.sweeps);
  }
  EXPECT_NEAR(sum_n, weight_n, 1e-3 * weight_n);
  for (int l = 0; l < kNumLegs; ++l) {
    const Vec3<double> drift = bench.report.foot_centre[l] - before[l];  // over 2 s
    EXPECT_LT(std::hypot(drift.x, drift.y), 1e-3);
    EXPECT_NEAR(bench.report.penetration[l], 0.0, 1e-4);
  }
  EXPECT_LT(most_sweeps, 50);
}

}  // namespace
}  // namespace sandrunner::sim
