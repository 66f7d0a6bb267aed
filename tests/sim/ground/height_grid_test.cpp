// SPDX-License-Identifier: BSD-3-Clause
// Heights from a file, and dunes: both are the same ground where they have the same heights.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/batch/batch.h"
#include "sim/simulator.h"
#include "tests/sim/support.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner::sim {
namespace {

constexpr double kDuneHeight_m = 0.2, kDuneLength_m = 4.0;

double dune_m(double x_m) {
  return 0.5 * kDuneHeight_m * (1.0 - std::cos(2.0 * std::numbers::pi * x_m / kDuneLength_m));
}

/// The dune sampled every 5 cm, as a file.
std::string dune_file() {
  constexpr int kColumns = 241, kRows = 41;
  std::string text = fmt::format(
      "ncols {}\nNROWS {}\nxllcorner 3e5\nyllcorner 4e6\ncellsize 0.05\n", kColumns, kRows);
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < kColumns; ++i) text += fmt::format("{} ", 7.0 + dune_m(0.05 * (i - 120)));
    text += "\n";
  }
  return text;
}

TerrainDescription described(const std::string& toml) {
  ConfigTree config;
  config.add_text("[terrain]\n" + toml, "my.toml");
  TerrainDescription terrain = read_terrain(config);
  config.reject_unknown();
  return terrain;
}

std::string grid_refusal(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder.path("g.asc"), text);
  const std::string error = error_of([&] { read_height_grid(folder.path("g.asc")); });
  return error.empty() ? error : error.substr(folder.path("").size());
}

TEST(HeightGridTest, HasTheHeightsOfItsFileAboveThatOfItsMiddle) {
  // The first row is the northernmost.
  const HeightGrid grid(3, 3, 2.0, {11, 12, 13, 21, 22, 23, 31, 32, 33});
  EXPECT_NEAR(grid.at(0.0, 0.0).height, 0.0, 1e-12);
  EXPECT_NEAR(grid.at(2.0, 0.0).height, 1.0, 1e-12);
  EXPECT_NEAR(grid.at(-2.0, 2.0).height, -11.0, 1e-12);
  EXPECT_NEAR(grid.at(0.0, 0.0).slope_x, 0.5, 1e-12);
  EXPECT_NEAR(grid.at(0.0, 0.0).slope_y, -5.0, 1e-12);
  // Beyond its edge the heights of the edge go on.
  EXPECT_NEAR(grid.at(50.0, 0.0).height, 1.0, 1e-12);
  EXPECT_EQ(grid.at(50.0, 0.0).slope_x, 0.0);
  EXPECT_TRUE(std::isfinite(grid.at(std::numeric_limits<double>::quiet_NaN(), 1e300).height));
}

TEST(HeightGridTest, IsSmoothBetweenItsHeightsAndStaysBelowItsCrest) {
  const HeightGrid grid(6, 5, 0.5, {0, 3, 1, 2, 0, 1, 2, 0, 0, 3, 1, 0, 0, 1, 3,
                                    0, 2, 2, 3, 0, 1, 1, 0, 3, 0, 2, 0, 3, 1, 0});
  constexpr double kStep_m = 1e-5;
  for (double y = -0.99; y < 1.0; y += 0.037) {
    for (double x = -1.24; x < 1.25; x += 0.041) {
      const Surface<double> s = grid.at(x, y);
      const auto slope = [&](double dx, double dy) {
        return (grid.at(x + dx, y + dy).height - grid.at(x - dx, y - dy).height) / (2.0 * kStep_m);
      };
      ASSERT_NEAR(s.slope_x, slope(kStep_m, 0.0), 2e-3) << x << " " << y;
      ASSERT_NEAR(s.slope_y, slope(0.0, kStep_m), 2e-3) << x << " " << y;
      ASSERT_LE(s.height, grid.crest_m());
    }
  }
}

TEST(HeightGridTest, ARobotStepsOnADuneAsOnTheSameDuneFromAFile) {
  const TemporaryFolder folder;
  write_file(folder.path("dune.asc"), dune_file());
  SimulatorConfig analytic, sampled;
  for (const char* kind : {"granular", "rigid"}) {
    analytic.terrain =
        described(fmt::format("kind = \"{}\"\ndune_height_m = {}\ndune_length_m = {}", kind,
                              kDuneHeight_m, kDuneLength_m));
    sampled.terrain = described(
        fmt::format("kind = \"{}\"\nheights_file = \"{}\"", kind, folder.path("dune.asc")));
    const Robot robot = load_raibo();
    Simulator a(robot, analytic), b(robot, sampled);
    EXPECT_NEAR(b.surface_height(1.0, 0.3), dune_m(1.0), 1e-5);
    for (Simulator* s : {&a, &b}) {
      s->push(0.5, 0.0);
      s->skip(2000, {});  // without torques it collapses where the dune is steep
    }
    const Vec3<double> off = a.state().robot.rigid.position - b.state().robot.rigid.position;
    EXPECT_LT(std::sqrt(dot(off, off)), 2e-3) << kind;
    RobotTruth on_a, on_b;
    a.truth(on_a);
    b.truth(on_b);
    EXPECT_NEAR(on_a.state.body_height_m, on_b.state.body_height_m, 2e-3) << kind;
  }
}

TEST(HeightGridTest, EachLaneOfABatchHasItsOwnToTheBitsOfARobotAlone) {
  const HeightGrid bumps(4, 4, 0.25,
                         {0, .02, .01, 0, .03, 0, .02, .01, 0, .02, 0, .03, .01, 0, .02, 0});
  const Robot robot = load_raibo();
  const TerrainDescription sand = terrain_preset("dry-sand");
  const FootProfile<double> foot = make_foot_profile(sand, robot.model);
  const auto run = [&](int robots, BatchWidth width) {
    Batch batch(robots, foot, {}, width);
    for (int i = 0; i < robots; ++i) {
      TerrainDescription terrain = sand;
      const bool has_bumps = robots == 1 || i % 3 == 1;
      if (has_bumps) terrain.shape.heights = std::make_shared<HeightGrid>(bumps);
      batch.set_model(i, convert_model<float>(robot.model));
      batch.set_terrain(i, convert_terrain<float>(make_terrain(terrain, foot, robot.model)));
      batch.set_heights(i, has_bumps ? &bumps : nullptr);
      RobotState<float> state;
      for (int j = 0; j < kNumJoints; ++j) state.rigid.q[j] = float(robot.nominal_rad[j]);
      state.rigid.position.z = float(robot.nominal_height_m) + 0.05f;
      batch.set_state(i, state);
    }
    for (int pack = 0; pack < batch.packs(); ++pack) batch.advance(pack, 1600);
    return batch;
  };
  const RobotState<float> alone = run(1, BatchWidth::kOne).state(0);
  const Batch many = run(8, BatchWidth::kEight);
  const RobotState<float> with = many.state(4), without = many.state(3);
  EXPECT_EQ(alone.rigid.q, with.rigid.q);
  EXPECT_EQ(alone.rigid.position.z, with.rigid.position.z);
  EXPECT_NE(with.rigid.q, without.rigid.q);
}

TEST(HeightGridTest, AFileThatIsNoGridIsRefusedInOneLine) {
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\ncellsize 1\n1 2 3 4\n"), "");
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\ncellsize 1\n1 2 3\n"),
            "g.asc: found 3 heights, expected 2 x 2");
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\ncellsize 1\n1 2 3 4 5\n"),
            "g.asc: found 5 heights, expected 2 x 2");
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\ncellsize 1\n1 2 x 4\n"),
            "g.asc: found 2 heights, expected 2 x 2");
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\ncellsize 1\n1 2 3 -99999\n"),
            "g.asc: found the height -99999, expected one from -10000 to 10000 (m)");
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\ncellsize 1\nNODATA_value -9999\n1 2 3 -9999\n"),
            "g.asc: found a cell without a height, expected one in every cell");
  EXPECT_EQ(grid_refusal("ncols 1\nnrows 2\ncellsize 1\n1 2\n"),
            "g.asc: found ncols 1, expected a whole number from 2 on");
  EXPECT_EQ(grid_refusal("ncols 1e6\nnrows 1e6\ncellsize 1\n"),
            "g.asc: found 1000000 x 1000000 heights, expected at most 16777216");
  EXPECT_EQ(grid_refusal("ncols 2\nnrows 2\n1 2 3 4\n"),
            "g.asc: found cellsize 0, expected a number from 0.001 to 1000 (m)");
  EXPECT_EQ(grid_refusal("\x89PNG\r\n"), "g.asc: found ncols 0, expected a whole number from 2 on");
}

}  // namespace
}  // namespace sandrunner::sim
