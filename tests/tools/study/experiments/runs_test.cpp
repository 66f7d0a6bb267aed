// SPDX-License-Identifier: BSD-3-Clause
// From runs to named numbers, and from and to JSON.
#include "tools/study/experiments/runs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rt/base/output_files.h"
#include "tests/support/not_finite.h"
#include "tests/support/temporary_folder.h"
#include "tools/study/experiments/contact_bench.h"
#include "tools/study/experiments/lab.h"

namespace sandrunner::study {
namespace {

TEST(RunsTest, MeasurementsAreReadAsTheyWereWritten) {
  Measured measured;
  measured.groups.push_back({"grass",
                             "turn",
                             -1.0,
                             {{"cotu", {0.1, kNan, 1.0 / 3.0}}},
                             {{"x", {1e-300, 2.0}}},
                             {{"hidden", "AAAA"}}});
  const Measured back = measured_from(Json::parse(to_json(measured).dump()));
  ASSERT_EQ(back.groups.size(), 1u);
  EXPECT_EQ(back.groups[0].ground, "grass");
  EXPECT_EQ(back.groups[0].scenario, "turn");
  EXPECT_EQ(back.groups[0].command, -1.0);
  EXPECT_EQ(back.groups[0].runs.at("cotu")[2], 1.0 / 3.0);
  EXPECT_TRUE(std::isnan(back.groups[0].runs.at("cotu")[1]));
  EXPECT_EQ(back.groups[0].lists, measured.groups[0].lists);
  EXPECT_EQ(back.groups[0].packed, measured.groups[0].packed);
}

TEST(ContactBenchTest, TheNumbersInItsTextsAreRead) {
  const TemporaryFolder folder;
  write_file(folder.path("contact.json"),
             R"({"processor": "made up", "cone_mm":
             "final depth 14.4 (quartiles 11.8 and 17.8), their range over it 0.42", "drft_mm":
             "final depth 51.0 (quartiles 40.0 and 60.0), their range over it 0.39; against", "planar_mm":
             "final depth 50.0 (quartiles 40.0 and 60.0), their range over it 0.40; against",
             "drft_vs_cone": {"median": 19.5, "q1": 19.0, "q3": 20.0, "runs": 5}})");
  const Json bench = read_contact_bench(folder.path("contact.json"));
  EXPECT_EQ(bench.at("ratio"), 19.5);
  EXPECT_EQ(bench.at("spread_cone"), 0.42);
  EXPECT_EQ(bench.at("spread_drft"), 0.39);
  EXPECT_EQ(bench.at("spread_planar"), 0.40);
}

TEST(RunFiguresTest, AStanceHasTheDepthOfItsDeepestMoment) {
  Ran run;
  const float depths_mm[] = {0, 10, 40, 20, 0, 0, 30, 0, 0.5f, 0, 50};
  for (const float depth : depths_mm) {
    Sample s;
    s.stance[2] = depth > 0.0f;
    s.depth_m[2] = 1e-3f * depth;
    run.samples.push_back(s);
  }
  // A foot that grazes makes no stance, and one that has not ended does not count.
  const std::vector<double> depths = stance_depths(run, 0, 2, 3);
  ASSERT_EQ(depths.size(), 2u);
  EXPECT_NEAR(depths[0], 0.040, 1e-6);
  EXPECT_NEAR(depths[1], 0.030, 1e-6);
  EXPECT_TRUE(stance_depths(run, 0, 0, 1).empty());
}

TEST(RunFiguresTest, ATurnSucceedsByMoreThanHalfATurnTheCommandedWay) {
  std::vector<Ran> runs(4);
  runs[0].figures.turned_rad = -1.1 * std::numbers::pi;
  runs[1].figures.turned_rad = -0.9 * std::numbers::pi;
  runs[2].figures.turned_rad = 1.1 * std::numbers::pi;
  runs[3].figures.turned_rad = -1.1 * std::numbers::pi;
  runs[3].figures.fell = true;
  EXPECT_EQ(turn_group("grass", -1.0, runs).runs.at("success"),
            (std::vector<double>{1.0, 0.0, 0.0, 0.0}));
}

TEST(RunFiguresTest, AStraightRunHasWhatSuccessIsJudgedBy) {
  std::vector<Ran> runs(3);
  runs[0].figures.track_done = runs[0].figures.track_limits_kept = true;
  runs[1].figures.track_done = runs[1].figures.track_stops_brief = true;
  runs[2].figures.failed_before_track = true;
  const RunGroup group = straight_group("beach", 1.0, runs);
  EXPECT_EQ(group.runs.at("reached"), (std::vector<double>{1.0, 1.0, 0.0}));
  EXPECT_EQ(group.runs.at("limits_kept"), (std::vector<double>{1.0, 0.0, 0.0}));
  EXPECT_EQ(group.runs.at("stops_brief"), (std::vector<double>{0.0, 1.0, 0.0}));
  EXPECT_EQ(group.runs.at("failed_before_track"), (std::vector<double>{0.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace sandrunner::study
