// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_feed.h"

#include <gtest/gtest.h>

#include <cstring>

namespace sandrunner {
namespace {

void add_frames(ViewFeed& feed, std::uint64_t from, std::uint64_t count) {
  for (std::uint64_t i = from; i < from + count; ++i) {
    RunRow row;
    row.t_s = static_cast<double>(i) / kPolicyHz;
    feed.add(row, {});
  }
}

/// The times of the frames in all messages that there are for a page, s.
std::vector<double> times(const ViewFeed& feed, ViewFeed::Place& place) {
  std::vector<double> all;
  for (std::string message; !(message = feed.next(place)).empty();) {
    std::uint32_t head[2];
    std::memcpy(head, message.data(), sizeof head);
    EXPECT_EQ(head[0], 0u);
    EXPECT_LE(message.size(), 50'008u);
    EXPECT_EQ(message.size(), sizeof head + head[1] * sizeof(RunRow));
    for (std::uint32_t i = 0; i < head[1]; ++i) {
      RunRow frame;
      std::memcpy(&frame, message.data() + sizeof head + i * sizeof frame, sizeof frame);
      all.push_back(frame.t_s);
    }
  }
  return all;
}

TEST(ViewFeedTest, APageThatComesLaterGetsThePastThenWhatIsNew) {
  ViewFeed feed{RunScene()};
  add_frames(feed, 0, 500);
  ViewFeed::Place place = feed.join();
  const std::vector<double> past = times(feed, place);
  ASSERT_EQ(past.size(), 500u);
  EXPECT_DOUBLE_EQ(past.front(), 0.0);
  EXPECT_DOUBLE_EQ(past.back(), 4.99);
  add_frames(feed, 500, 3);
  EXPECT_EQ(times(feed, place).size(), 3u);
  EXPECT_TRUE(times(feed, place).empty());
  EXPECT_FALSE(feed.ended());
  feed.end();
  EXPECT_TRUE(feed.ended());
}

TEST(ViewFeedTest, APageThatFallsBehindSkipsToTheNewestFrame) {
  ViewFeed feed{RunScene()};
  ViewFeed::Place place = feed.join();
  add_frames(feed, 0, 500);
  const std::vector<double> got = times(feed, place);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_DOUBLE_EQ(got.front(), 4.99);
}

TEST(ViewFeedTest, ThePastIsBounded) {
  ViewFeed feed(RunScene(), {.frames = 10, .footprints = 10, .tiles = 10});
  add_frames(feed, 0, 100);
  ViewFeed::Place place = feed.join();
  EXPECT_EQ(times(feed, place).size(), 10u);
}

TEST(ViewFeedTest, RoughGroundComesBeforeTheFramesOnIt) {
  RunScene scene;
  scene.waves_m = [](double x_m, double) { return 0.01 * x_m; };
  ViewFeed feed(scene);
  add_frames(feed, 0, 3);
  ViewFeed::Place place = feed.join();
  const std::string message = feed.next(place);
  std::uint32_t head[2];
  ASSERT_GT(message.size(), sizeof head);
  std::memcpy(head, message.data(), sizeof head);
  EXPECT_EQ(head[0], 2u);
  EXPECT_EQ(message.size(), sizeof head + head[1] * sizeof(ViewTile));
}

TEST(ViewFeedTest, GroundThatWasForgottenIsThereAgainForARobotThatComesBack) {
  RunScene scene;
  scene.waves_m = [](double x_m, double) { return 0.01 * x_m; };
  ViewFeed feed(scene, {.frames = 10, .footprints = 10, .tiles = 200});
  for (const double x_m : {0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 0.0}) {
    RunRow row;
    row.position_m = {x_m, 0.0, 0.5};
    feed.add(row, {});
  }
  feed.end();
  ViewFeed::Place place = feed.join();
  bool there = false;
  for (std::string message; !(message = feed.next(place)).empty();) {
    std::uint32_t head[2];
    std::memcpy(head, message.data(), sizeof head);
    for (std::uint32_t i = 0; head[0] == 2 && i < head[1]; ++i) {
      ViewTile tile;
      std::memcpy(&tile, message.data() + sizeof head + i * sizeof tile, sizeof tile);
      there = there || (tile.tile_x == 0 && tile.tile_y == 0);
    }
  }
  EXPECT_TRUE(there);
}

}  // namespace
}  // namespace sandrunner
