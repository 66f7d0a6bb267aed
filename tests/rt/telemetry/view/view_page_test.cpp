// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

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
  scene.leg_names = example_robot().leg_names;
  scene.joint_names = example_robot().joint_names;
  scene.foot_radius_m = 0.02;
  return scene;
}

/// A page of this many frames, whose torques no packer can foresee.
std::string page_of(std::size_t frames, const ViewPageLimits& limits) {
  ViewPage page(example_scene(), example_robot(), limits);
  std::uint64_t noise = 1;
  for (std::size_t i = 0; i < frames; ++i) {
    TickRecord tick = example_tick(i * kTicksPerPolicyStep);
    for (double& torque : tick.input.sensors.joints.torque_nm) {
      noise = noise * 6364136223846793005u + 1442695040888963407u;
      torque = 1e-18 * static_cast<double>(noise);
    }
    if (i == 10) tick.input.sensors.joints.torque_nm[7] = 500.0;
    page.add(tick);
  }
  return page.html();
}

std::vector<ViewFrame> frames_in(const std::string& page) {
  return unpacked<ViewFrame>(view_frame_fields(), element(page, "frames"));
}

TEST(ViewPageTest, AShortRunIsThereFrameByFrame) {
  const std::string page = page_of(300, {});
  EXPECT_EQ(page.substr(0, 15), "<!doctype html>");
  const auto frames = frames_in(page);
  ASSERT_EQ(frames.size(), 300u);
  EXPECT_DOUBLE_EQ(frames.back().t_s, 2.99);
  const Json hello = Json::parse(element(page, "hello"));
  EXPECT_EQ(hello.at("rate_hz"), 100);
  EXPECT_NE(hello.at("note").get<std::string>().find("measured or estimated"), std::string::npos);
}

TEST(ViewPageTest, ALearningCurveComesWithTheRunWhereThereIsOne) {
  ViewPage page(example_scene(), example_robot());
  page.add(example_tick(0));
  const std::string curve = R"({"title":"<script>"})";
  EXPECT_EQ(gunzip(from_base64(element(page.html(curve), "curve-data"))), curve);
  EXPECT_EQ(page.html().find("curve-data"), std::string::npos);
}

TEST(ViewPageTest, LongRunsAreShownAtLowerRatesThatTheyState) {
  for (const auto& [count, rate] : {std::pair{1500, 50}, std::pair{3000, 25}}) {
    const std::string page = page_of(static_cast<std::size_t>(count), {.frames = 1000});
    const auto frames = frames_in(page);
    EXPECT_LT(frames.size(), 1000u);
    EXPECT_NEAR(frames.back().t_s, 0.01 * (count - 1), 0.041);
    EXPECT_LT(frames.front().t_s, 0.041);
    for (std::size_t i = 1; i < frames.size(); ++i) {
      EXPECT_NEAR(frames[i].t_s - frames[i - 1].t_s, 1.0 / rate, 1e-9);
    }
    // A peak survives, in the next frame that is kept.
    const auto peak = std::ranges::max_element(
        frames, {}, [](const ViewFrame& f) { return std::abs(f.peak_torque_nm[7]); });
    EXPECT_EQ(peak->peak_torque_nm[7], 500.0f);
    EXPECT_NEAR(peak->t_s, 0.1, 0.041);
    const Json hello = Json::parse(element(page, "hello"));
    EXPECT_EQ(hello.at("rate_hz"), rate);
    const std::string stated = std::to_string(rate) + " frames a second";
    EXPECT_NE(hello.at("note").get<std::string>().find(stated), std::string::npos);
  }
}

TEST(ViewPageTest, OfAVeryLongRunTheEndIsThere) {
  const std::string page = page_of(20'000, {.frames = 1000});
  const auto frames = frames_in(page);
  EXPECT_LT(frames.size(), 1000u);
  EXPECT_GT(frames.size(), 700u);
  EXPECT_NEAR(frames.back().t_s, 199.99, 0.041);
  const std::string note = Json::parse(element(page, "hello")).at("note");
  EXPECT_NE(note.find("Only its end, from "), std::string::npos) << note;
}

TEST(ViewPageTest, NoPageIsLargerThanItsLimit) {
  const std::size_t whole = page_of(4000, {}).size();
  const ViewPageLimits limits{.bytes = whole / 2};
  const std::string page = page_of(4000, limits);
  EXPECT_LE(page.size(), limits.bytes);
  EXPECT_GT(frames_in(page).size(), 100u);
}

TEST(ViewPageTest, ARunWithoutATickHasAPageThatSaysSo) {
  ViewPage page(example_scene(), example_robot());
  const Json hello = Json::parse(element(page.html(), "hello"));
  EXPECT_EQ(hello.at("note"), "Not one frame was seen of this run.");
}

TEST(ViewPageTest, TheSameRunGivesTheSameBytesAndLeavesTheRunAlone) {
  const ProcessConfig config = config_of("dry-sand");
  Policy policy = random_policy();
  std::array<std::string, 2> pages;
  std::array<std::uint64_t, 2> hashes{};
  for (std::size_t i = 0; i < 2; ++i) {
    ViewPage page(scene_of(config, "p"), config.robot.description);
    const RunResult result = simulate({.config = config,
                                       .policy = &policy,
                                       .plan = {.walk_s = 0.5, .start_walking = true},
                                       .tap = [&](const TickRecord& tick) { page.add(tick); }});
    pages[i] = page.html();
    hashes[i] = result.end.state_hash;
  }
  EXPECT_TRUE(pages[0] == pages[1]);
  EXPECT_EQ(hashes[0], hashes[1]);
  const RunResult without = run_once(config, &policy, {.walk_s = 0.5, .start_walking = true});
  EXPECT_EQ(without.end.state_hash, hashes[0]);
}

TEST(ViewPageTest, NothingInARobotsFileCanEndAnElementOfThePage) {
  RobotDescription robot = example_robot();
  robot.ros_urdf = "<robot></script><script>alert(1)</script><!--\xff</robot>";
  const std::string hello = view_hello(example_scene(), robot, 100, "<b>");
  EXPECT_EQ(hello.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(hello).at("note"), "<b>");
}

TEST(ViewHelloTest, FeetAreTheLinksBelowTheLastJoints) {
  const ProcessConfig config = config_of("dry-sand");
  const Json hello =
      Json::parse(view_hello(scene_of(config, ""), config.robot.description, 100, ""));
  EXPECT_EQ(hello.at("feet"), (Json{"LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT"}));
  const TemporaryFolder folder;
  const ProcessConfig small = config_of("dry-sand", {"robot=" + write_small_robot(folder)});
  EXPECT_EQ(
      Json::parse(view_hello(scene_of(small, ""), small.robot.description, 100, "")).at("feet"),
      (Json{"fl_ball", "fr_ball", "rl_ball", "rr_ball"}));
  EXPECT_EQ(hello.at("base"), "base_link");
  EXPECT_EQ(hello.at("modes").at(4), "walk");
  EXPECT_EQ(hello.at("faults").size(), static_cast<std::size_t>(kNumFaults));
}

TEST(ViewTilesTest, RoughGroundIsThereWhereTheRobotWas) {
  RunScene scene = example_scene();
  std::vector<ViewFrame> way(2);
  way[1].position_m = {20.0, -3.0, 0.5};
  EXPECT_TRUE(view_tiles(scene, way, 1000).empty());
  scene.ground_height_m = [](double x, double y) { return 0.01 * x - 0.02 * y; };
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

TEST(ViewPackTest, Base64IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace sandrunner
