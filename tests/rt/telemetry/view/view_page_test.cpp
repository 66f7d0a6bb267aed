// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_page.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rt/core/mode_machine.h"
#include "rt/report/run_observer.h"
#include "rt/telemetry/view/view_hello.h"
#include "rt/telemetry/view/view_pack.h"
#include "rt/telemetry/view/view_tiles.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/rt/telemetry/view/packed.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

using Json = nlohmann::json;

RunScene example_scene() {
  RunScene scene;
  scene.terrain = "dry-sand";
  scene.robot = example_robot();
  scene.foot_radius_m = 0.02;
  return scene;
}

/// A run of this many periods, whose torques no packer can foresee.
RunRecord record_of(std::size_t periods) {
  RunObserver observer(example_scene());
  std::uint64_t noise = 1;
  for (std::size_t i = 0; i < periods; ++i) {
    TickRecord tick = example_tick(i * kTicksPerPolicyStep);
    for (double& torque : tick.input.sensors.joints.torque_nm) {
      noise = noise * 6364136223846793005u + 1442695040888963407u;
      torque = 1e-18 * static_cast<double>(noise);
    }
    if (i == 10) tick.input.sensors.joints.torque_nm[7] = 500.0;
    observer.add(tick);
  }
  return observer.take_record();
}

std::vector<RunRow> rows_in(const std::string& page) {
  return unpacked<RunRow>(page_fields(), element(page, "frames"));
}

TEST(ViewPageTest, AShortRunIsThereRowByRow) {
  const std::string page = run_page(record_of(300));
  EXPECT_EQ(page.substr(0, 15), "<!doctype html>");
  const auto rows = rows_in(page);
  ASSERT_EQ(rows.size(), 300u);
  EXPECT_DOUBLE_EQ(rows.back().t_s, 2.99);
  const Json hello = Json::parse(element(page, "hello"));
  EXPECT_EQ(hello.at("note").get<std::string>().find("A long run"), std::string::npos);
  EXPECT_NE(hello.at("note").get<std::string>().find("measured or estimated"), std::string::npos);
}

TEST(ViewPageTest, ALearningCurveComesWithTheRunWhereThereIsOne) {
  const std::string curve = R"({"title":"<script>"})";
  const std::string page = run_page(record_of(1), 16'000'000, curve);
  EXPECT_EQ(gunzip(from_base64(element(page, "curve-data"))), curve);
  EXPECT_EQ(run_page(record_of(1)).find("curve-data"), std::string::npos);
}

TEST(ViewPageTest, AFootOnHardGroundLeavesNoFootprint) {
  RunRecord record = record_of(1);
  record.add(Footprint{.t_s = 0.1, .depth_m = 0.001f});
  record.add(Footprint{.t_s = 0.2, .depth_m = 0.03f});
  const auto prints =
      unpacked<Footprint>(kFootprintFields, element(run_page(record), "footprints"));
  ASSERT_EQ(prints.size(), 1u);
  EXPECT_EQ(prints[0].t_s, 0.2);
}

TEST(ViewPageTest, NoPageIsLargerThanItsLimitAndItStatesItsRate) {
  const RunRecord record = record_of(4000);
  const std::size_t most_bytes = (run_page(record).size() + 3 * run_page({}).size()) / 4;
  const std::string page = run_page(record, most_bytes);
  EXPECT_LE(page.size(), most_bytes);
  const auto rows = rows_in(page);
  ASSERT_GT(rows.size(), 100u);
  const double rate_hz = 1.0 / (rows[1].t_s - rows[0].t_s);
  EXPECT_LT(rate_hz, 51.0);
  EXPECT_NEAR(rows.back().t_s, 39.99, 1.0 / rate_hz);
  const std::string note = Json::parse(element(page, "hello")).at("note");
  EXPECT_NE(note.find(fmt::format("{:.4g} frames a second", rate_hz)), std::string::npos) << note;
  // A peak survives, in the next row that is kept.
  const auto peak = std::ranges::max_element(
      rows, {}, [](const RunRow& row) { return std::abs(row.peak_torque_nm[7]); });
  EXPECT_EQ(peak->peak_torque_nm[7], 500.0f);
  EXPECT_NEAR(peak->t_s, 0.1, 1.0 / rate_hz);
}

TEST(ViewPageTest, ARunWithoutATickHasAPageThatSaysSo) {
  const Json hello = Json::parse(element(run_page({.scene = example_scene()}), "hello"));
  EXPECT_EQ(hello.at("note"), "Not one frame was seen of this run.");
}

TEST(ViewPageTest, TheSameRunGivesTheSameBytes) {
  const ProcessConfig config = config_of("dry-sand");
  PolicyRunner policy(random_policy());
  std::array<std::string, 2> pages;
  std::array<std::uint64_t, 2> hashes{};
  for (std::size_t i = 0; i < 2; ++i) {
    const RunResult result = simulate(
        {.config = config, .policy = policy, .plan = {.walk_s = 0.5, .start_walking = true}});
    pages[i] = run_page(result.record);
    hashes[i] = result.end.state_hash;
  }
  EXPECT_TRUE(pages[0] == pages[1]);
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(ViewPageTest, NothingInARobotsFileCanEndAnElementOfThePage) {
  RunScene scene = example_scene();
  scene.robot.ros_urdf = "<robot></script><script>alert(1)</script><!--\xff</robot>";
  const std::string hello = view_hello(scene, "<b>");
  EXPECT_EQ(hello.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(hello).at("note"), "<b>");
}

TEST(ViewHelloTest, FeetAreTheLinksBelowTheLastJoints) {
  const ProcessConfig config = config_of("dry-sand");
  const Json hello = Json::parse(view_hello(scene_of(config, ""), ""));
  EXPECT_EQ(hello.at("feet"), (Json{"LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT"}));
  const TemporaryFolder folder;
  const ProcessConfig small = config_of("dry-sand", {"robot=" + write_small_robot(folder)});
  EXPECT_EQ(Json::parse(view_hello(scene_of(small, ""), "")).at("feet"),
            (Json{"fl_ball", "fr_ball", "rl_ball", "rr_ball"}));
  const ProcessConfig go2 = config_of("dry-sand", {"robot=go2"});
  EXPECT_EQ(Json::parse(view_hello(scene_of(go2, ""), "")).at("feet"),
            (Json{"FL_foot", "FR_foot", "RL_foot", "RR_foot"}));
  EXPECT_EQ(hello.at("base"), "base_link");
  EXPECT_EQ(hello.at("modes").at(4), "walk");
  EXPECT_EQ(hello.at("faults").size(), static_cast<std::size_t>(kNumFaults));
}

TEST(ViewHelloTest, PageLearnsRequestsFlagsAndKindsOfRowsFromTheServer) {
  const Json hello = Json::parse(view_hello(example_scene(), ""));
  ASSERT_EQ(hello.at("requests").size(), kRequestTable.size());
  EXPECT_EQ(
      hello.at("requests").at(3),
      (Json{{"name", "stop"}, {"key", " "}, {"refused", Json::array({"", "", "", "", "", ""})}}));
  const Json& reset = hello.at("requests").at(7);
  EXPECT_EQ(reset.at("name"), "reset_fault");
  EXPECT_EQ(reset.at("key"), "");
  EXPECT_EQ(reset.at("refused").at(static_cast<int>(Mode::kWalk)), "no fault is latched");
  EXPECT_EQ(reset.at("refused").at(static_cast<int>(Mode::kFault)), "");
  EXPECT_EQ(hello.at("row_flags").at("has_truth"), kRowHasTruth);
  EXPECT_EQ(hello.at("row_kinds").at(static_cast<int>(ViewRowKind::kTiles)), "tiles");
  EXPECT_EQ(hello.at("no_truth"), kNoTruthNote);
}

TEST(ViewTilesTest, RoughGroundIsThereWhereTheRobotWas) {
  RunScene scene = example_scene();
  std::deque<RunRow> way(2);
  way[1].position_m = {20.0, -3.0, 0.5};
  EXPECT_TRUE(view_tiles(scene, way, 1000).empty());
  scene.waves_m = [](double x, double y) { return 0.01 * x - 0.02 * y; };
  const auto tiles = view_tiles(scene, way, 1000);
  EXPECT_EQ(tiles.size(), 98u);
  const double side_m = kViewTileSide * kViewTileStep_m;
  for (const ViewTile& tile : tiles) {
    const double x = side_m * tile.tile_x + 5 * kViewTileStep_m;
    const double y = side_m * tile.tile_y + 7 * kViewTileStep_m;
    EXPECT_NEAR(1e-4 * tile.height_tenth_mm[7 * kViewTileSide + 5], 0.01 * x - 0.02 * y, 6e-5);
  }
  EXPECT_EQ(view_tiles(scene, way, 10).size(), 10u);
}

TEST(ViewTilesTest, ASlopeIsInTheHelloAndUnderTheWaves) {
  RunScene scene = example_scene();
  scene.slope = {0.1, -0.2};
  EXPECT_EQ(Json::parse(view_hello(scene, "")).at("slope"), (Json{0.1, -0.2}));
  EXPECT_NEAR(scene.ground_height_m(3.0, 1.0), 0.1, 1e-12);
  EXPECT_TRUE(view_tiles(scene, std::deque<RunRow>(2), 1000).empty());
  scene.waves_m = [](double, double) { return 0.01; };
  EXPECT_NEAR(scene.ground_height_m(3.0, 1.0), 0.11, 1e-12);
}

TEST(ViewPackTest, WhatIsNotANumberStaysInItsOwnPlace) {
  std::vector<RunRow> rows(10);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].t_s = 0.01 * static_cast<double>(i);
    rows[i].position_m = {1.0 + 1e-4 * static_cast<double>(i), 2.0, 0.5};
    rows[i].peak_torque_nm.fill(3.0f);
    rows[i].flags = kRowHasTruth;
  }
  rows[2].position_rad[3] = std::numeric_limits<float>::quiet_NaN();
  std::string packed;
  append_rows(packed, kRowFields, rows);
  const auto back = unpacked<RunRow>(kRowFields, packed);
  ASSERT_EQ(back.size(), rows.size());
  int missing = 0;
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].t_s, rows[i].t_s);
    EXPECT_EQ(back[i].position_m, rows[i].position_m);
    EXPECT_EQ(back[i].peak_torque_nm, rows[i].peak_torque_nm);
    EXPECT_EQ(back[i].flags, rows[i].flags);
    for (const float q : back[i].position_rad) missing += std::isnan(q) ? 1 : 0;
  }
  EXPECT_EQ(missing, 1);
  EXPECT_TRUE(std::isnan(back[2].position_rad[3]));
}

TEST(ViewPackTest, Base64IsThatOfRfc4648) {
  const auto base64 = [](std::string_view bytes) {
    std::string text;
    append_base64(text, bytes);
    return text;
  };
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace sandrunner
