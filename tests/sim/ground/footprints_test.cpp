// SPDX-License-Identifier: BSD-3-Clause
// A ground that remembers what feet have left in it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "sim/batch/batch.h"
#include "sim/lanes/random.h"
#include "sim/simulator.h"
#include "tests/sim/ground/granular_foot.h"

namespace sandrunner::sim {
namespace {

constexpr double kRadius_m = 0.03, kRepose = 0.67;

void leave_print(Footprints& prints, double x_m, double y_m, double depth_m) {
  prints.follow(0, {true, x_m, y_m, depth_m, kRadius_m, kRepose});
  prints.follow(0, {false, x_m, y_m, -0.1, kRadius_m, kRepose});
}

TEST(FootprintsTest, NoGrainIsLost) {
  auto prints = std::make_unique<Footprints>();
  double dug_m3 = 0.0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const auto draw = [&](std::uint64_t n) { return random_uniform(1, n, i) - 0.5; };
    const double before_m = prints->height_at(draw(1), draw(2));
    const double depth_m = 0.06 + 0.08 * draw(3);
    leave_print(*prints, draw(1), draw(2), depth_m);
    dug_m3 += std::numbers::pi * kRadius_m * kRadius_m * std::max(depth_m + before_m, 0.0);
  }
  EXPECT_GT(dug_m3, 0.01);
  EXPECT_LT(std::fabs(prints->volume_m3()), 1e-6 * dug_m3);
}

TEST(FootprintsTest, APrintIsAHollowWithARimNoSteeperThanTheAngleOfRepose) {
  auto prints = std::make_unique<Footprints>();
  leave_print(*prints, 0.01, 0.01, 0.07);
  EXPECT_LT(prints->height_at(0.01, 0.01), -0.02);
  EXPECT_GE(prints->height_at(0.01, 0.01), -0.07);
  double highest_m = 0.0, steepest = 0.0;
  for (int i = -20; i < 20; ++i) {
    for (int j = -20; j < 20; ++j) {
      const double x = 0.01 + i * Footprints::kCell_m, y = 0.01 + j * Footprints::kCell_m;
      const double here_m = prints->height_at(x, y);
      highest_m = std::max(highest_m, here_m);
      for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
        const double there_m =
            prints->height_at(x + dx * Footprints::kCell_m, y + dy * Footprints::kCell_m);
        steepest = std::max(
            steepest, std::fabs(there_m - here_m) / (Footprints::kCell_m * std::hypot(dx, dy)));
      }
    }
  }
  EXPECT_GT(highest_m, 0.002);
  EXPECT_LT(steepest, kRepose + 0.006);
  EXPECT_GT(steepest, 0.9 * kRepose);
}

TEST(FootprintsTest, ASoleLeavesAFlatBottomAndABallAHollow) {
  for (const bool flat : {true, false}) {
    auto prints = std::make_unique<Footprints>();
    prints->follow(0, {true, 0.01, 0.01, 0.01, 0.06, kRepose, flat});
    prints->follow(0, {false, 0.01, 0.01, 0.0, 0.06, kRepose, flat});
    EXPECT_NEAR(prints->height_at(0.01, 0.01), -0.01, 1e-6);
    EXPECT_NEAR(prints->height_at(0.05, 0.01), flat ? -0.01 : 0.0, flat ? 1e-6 : 5e-3);
  }
}

TEST(FootprintsTest, TheSquareGoesWithTheRobotAndForgetsWhatItLeaves) {
  auto prints = std::make_unique<Footprints>();
  leave_print(*prints, 0.01, 0.01, 0.05);
  const double depth_m = prints->height_at(0.01, 0.01);
  prints->keep_around(1.0, -0.8);
  EXPECT_EQ(prints->height_at(0.01, 0.01), depth_m);
  EXPECT_EQ(prints->height_at(0.01 + Footprints::kSide * Footprints::kCell_m, 0.01), 0.0);
  prints->keep_around(5.0, 0.0);
  prints->keep_around(0.0, 0.0);
  EXPECT_EQ(prints->height_at(0.01, 0.01), 0.0);
  prints->keep_around(1e300, std::nan(""));
  EXPECT_EQ(prints->height_at(1e300, 0.0), 0.0);
}

TEST(FootprintsTest, TheGroundUnderAPrintIsAsStrongAsAtThatDepth) {
  GroundParameters sand = ground_of_kind(GroundKind::kGranular);
  sand.inertial_drag = sand.added_mass = sand.filter = false;
  Foot foot(sand);
  const FootForce<double> force = foot_force(
      foot.ground, foot.profile, {.z = 0.001, .v = 0.1, .pressed = 0.04}, 4000.0, foot.contact);
  EXPECT_NEAR(force.raw, foot.quasistatic(0.041), 1e-9);
}

TEST(FootprintsTest, MudUnderAPrintIsAsStrongAsAtThatDepth) {
  GroundParameters mud = ground_of_kind(GroundKind::kMud);
  mud.strength_pa = 1.0;
  // Pushed in slowly; strength grows with depth from next to nothing.
  const auto force_at = [&](double z, double pressed) {
    Foot foot(mud);
    double force = 0.0;
    for (double at = 0.0; at < z; at += 1e-6) {
      force = foot_force(foot.ground, foot.profile, {.z = at, .v = 1e-3, .pressed = pressed},
                         4000.0, foot.contact)
                  .normal;
    }
    return force;
  };
  EXPECT_GT(force_at(0.005, 0.1), 15.0 * force_at(0.005, 0.0));
}

TEST(FootprintsTest, HardGroundLiftsFeetOutOfTheirPrints) {
  SimulatorConfig config;
  config.terrain = terrain_preset("dry-sand");
  config.terrain.patches[0].ground.footprints = true;
  const Robot robot = load_raibo();
  Simulator simulator(robot, config);
  SimulatorState state = simulator.state();
  for (int leg = 0; leg < kNumLegs; ++leg) {  // where the feet are going to stand
    const auto p = leg_pose(robot.model.legs[leg], robot.nominal_rad[3 * leg],
                            robot.nominal_rad[3 * leg + 1], robot.nominal_rad[3 * leg + 2]);
    const Vec3<double> foot = hip_to_base(robot.model.legs[leg], p, p.foot);
    state.footprints.follow(leg, {true, foot.x, foot.y, 0.08, 0.06, kRepose});
    state.footprints.follow(leg, {false, foot.x, foot.y, 0.0, 0.06, kRepose});
  }
  simulator.restore(state);
  simulator.skip(1200, {});  // without torques: it sinks into them
  double lowest_m = 1.0;
  for (const Vec3<double>& centre : simulator.report().foot_centre) {
    lowest_m = std::min(lowest_m, centre.z - robot.model.foot_radius_m);
  }
  ASSERT_LT(lowest_m, -0.02);
  const double before_m = simulator.state().robot.rigid.position.z;
  simulator.set_terrain(terrain_preset("rigid"));
  EXPECT_NEAR(simulator.state().robot.rigid.position.z, before_m - lowest_m, 1e-3);
}

TEST(FootprintsTest, AFootThatIsPutElsewhereLeavesNoPrintAndFindsWhatIsThere) {
  auto prints = std::make_unique<Footprints>();
  leave_print(*prints, 0.01, 0.01, 0.06);
  const double there_m = prints->height_at(0.01, 0.01);
  prints->height_under(1, false, 0.5, 0.5);
  prints->follow(1, {true, 0.5, 0.5, 0.05, kRadius_m, kRepose});
  prints->move_feet();
  EXPECT_EQ(prints->height_under(1, true, 0.01, 0.01), there_m);
  prints->follow(1, {false, 0.5, 0.5, -0.1, kRadius_m, kRepose});
  EXPECT_EQ(prints->height_at(0.5, 0.5), 0.0);
}

/// A step of a robot whose drives hold its nominal pose.
void step_on(Footprints& prints, Bench& bench) {
  std::array<double, kNumJoints> torque_nm;
  for (int j = 0; j < kNumJoints; ++j) {
    const double q = bench.state.rigid.q[j], qd = bench.state.rigid.qd[j];
    torque_nm[j] = 200.0 * (bench.robot.nominal_rad[j] - q) - 5.0 * qd;
  }
  bench.stepper.step(bench.robot.model, bench.foot, bench.terrain, bench.settings, torque_nm,
                     bench.state, bench.report, {}, {{&prints}});
}

TEST(FootprintsTest, AFootThatStepsIntoItsPrintFindsNothingAboveItsBottom) {
  GroundParameters sand = ground_of_kind(GroundKind::kGranular);
  sand.footprints = true;
  auto prints = std::make_unique<Footprints>();
  Bench bench(sand);
  for (int i = 0; i < 4000; ++i) step_on(*prints, bench);
  const auto depth_m = [&](int leg) {
    return bench.robot.model.foot_radius_m - bench.report.foot_centre[leg].z;
  };
  EXPECT_GT(depth_m(0), 0.02);
  bench.state.rigid.position.z += 0.2;
  step_on(*prints, bench);
  const double left_m =
      -prints->height_at(bench.report.foot_centre[0].x, bench.report.foot_centre[0].y);
  ASSERT_GT(left_m, 0.01);
  bench.state.rigid.velocity = {0.0, 0.0, -0.5};
  bench.state.rigid.qd = {};
  bool touched = false;
  for (int i = 0; i < 4000 && !touched; ++i) {
    step_on(*prints, bench);
    touched = bench.report.raw_force[0] > 0.0;
    if (!touched) continue;
    EXPECT_GT(depth_m(0), left_m - 0.003);
  }
  EXPECT_TRUE(touched);
}

TEST(FootprintsTest, EachLaneOfABatchHasItsOwnToTheBitsOfARobotAlone) {
  const Robot robot = load_raibo();
  TerrainDescription sand = terrain_preset("dry-sand");
  sand.patches[0].ground.footprints = true;
  const FootProfile<double> foot = make_foot_profile(sand, robot.model);
  const auto run = [&](int robots, BatchWidth width, std::vector<Footprints>& prints) {
    Batch batch(robots, foot, {}, width);
    for (int i = 0; i < robots; ++i) {
      const bool has_prints = robots == 1 || i % 3 == 1;
      batch.set_model(i, convert_model<float>(robot.model));
      batch.set_terrain(i, convert_terrain<float>(make_terrain(sand, foot, robot.model)));
      if (has_prints) batch.set_footprints(i, &prints[static_cast<std::size_t>(i)]);
      RobotState<float> state;
      for (int j = 0; j < kNumJoints; ++j) state.rigid.q[j] = float(robot.nominal_rad[j]);
      state.rigid.position.z = float(robot.nominal_height_m);
      state.rigid.velocity.x = 1.5f;
      batch.set_state(i, state);
    }
    for (int pack = 0; pack < batch.packs(); ++pack) batch.advance(pack, 4000);
    return batch;
  };
  std::vector<Footprints> one(1), eight(8);
  const RobotState<float> alone = run(1, BatchWidth::kOne, one).state(0);
  const Batch many = run(8, BatchWidth::kEight, eight);
  EXPECT_EQ(alone.rigid.q, many.state(4).rigid.q);
  const auto hash = [](const Footprints& prints) {
    StateHash h;
    h.add(prints);
    return h.value();
  };
  EXPECT_EQ(hash(one[0]), hash(eight[4]));
  EXPECT_EQ(hash(eight[1]), hash(eight[4]));
  EXPECT_NE(hash(eight[0]), hash(eight[4]));
}

}  // namespace
}  // namespace sandrunner::sim
