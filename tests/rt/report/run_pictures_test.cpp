// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "rt/base/errors.h"
#include "rt/report/run_csv.h"
#include "tests/rt/plot/picture.h"
#include "tests/rt/report/made_up_trot.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

class RunPicturesTest : public testing::Test {
 protected:
  const TemporaryFolder folder_;
};

TEST_F(RunPicturesTest, PlotShowsEverySeriesOfEveryPanel) {
  const std::string path = folder_.path("run_plot.png");
  draw_run_plot(trot(8.0, flat, kSinkage_m), path);
  EXPECT_EQ(folder_.number_of_files(), 1u) << "no part of a file is left";
  const Picture picture(path);
  EXPECT_EQ(picture.width(), 1800);
  constexpr int kPanels = 8;
  constexpr int kPanel_px = 174;
  EXPECT_EQ(picture.height(), 80 + kPanels * kPanel_px + 56);
  for (int panel = 0; panel < kPanels; ++panel) {
    const int top = 80 + panel * kPanel_px;
    int blank = 0;
    int drawn = 0;
    for (int y = top + 40; y < top + kPanel_px; ++y) {
      for (int x = 300; x < 1700; ++x) {
        const Rgb pixel = picture.at(x, y);
        const int spread = std::max({pixel.red, pixel.green, pixel.blue}) -
                           std::min({pixel.red, pixel.green, pixel.blue});
        ++(spread > 60 ? drawn : blank);
      }
    }
    EXPECT_GT(drawn, 700) << "panel " << panel;
    EXPECT_GT(blank, 700) << "panel " << panel;
  }
}

TEST_F(RunPicturesTest, StripShowsTheRobotInEveryViewAndItsFootprints) {
  RunRecord record = trot(8.0, flat, kSinkage_m);
  const std::string path = folder_.path("run_strip.png");
  draw_run_strip(record, path);
  const Picture picture(path);
  EXPECT_EQ(picture.width(), 1798);
  EXPECT_EQ(picture.height(), 578);
  const plot::Color body{0.93, 0.52, 0.13};
  const plot::Color near_leg{0.10, 0.20, 0.33};
  for (int view = 0; view < 10; ++view) {
    const int left = 8 + view % 5 * 358;
    const int top = 46 + view / 5 * 266;
    EXPECT_GT(picture.count(body, left, top, left + 350, top + 258), 2000) << view;
    EXPECT_GT(picture.count(near_leg, left, top, left + 350, top + 258), 1000) << view;
  }

  record.footprints.clear();
  const std::string bare_path = folder_.path("run_strip_without_footprints.png");
  draw_run_strip(record, bare_path);
  const Picture bare(bare_path);
  const auto sand = [](const Picture& p) {  // in the last view
    return p.count({0.90, 0.80, 0.60}, 1440, 312, 1790, 570);
  };
  EXPECT_LT(sand(picture), sand(bare) - 800);
}

TEST_F(RunPicturesTest, StripShowsLeftLegsBesideRightOnesThatMoveAlike) {
  RunRecord record = trot(8.0, flat, kSinkage_m);
  const auto mirrored = [](const std::array<float, 3>& p) { return std::array{p[0], -p[1], p[2]}; };
  for (RunRow& row : record.rows) {
    for (std::size_t left = 0; left < kNumLegs; left += 2) {
      row.hip_m[left] = mirrored(row.hip_m[left + 1]);
      row.knee_m[left] = mirrored(row.knee_m[left + 1]);
      row.foot_m[left] = mirrored(row.foot_m[left + 1]);
    }
  }
  draw_run_strip(record, folder_.path("bound.png"));
  const Picture picture(folder_.path("bound.png"));
  for (int view = 0; view < 10; ++view) {
    const int left = 8 + view % 5 * 358;
    const int top = 46 + view / 5 * 266;
    EXPECT_GT(picture.count({0.47, 0.60, 0.74}, left, top, left + 350, top + 258), 500) << view;
  }
}

TEST_F(RunPicturesTest, PlotZoomsIntoTheGaitAndNotTheStop) {
  RunRecord record = trot(8.0, flat, kSinkage_m);
  const double stop_s = 7.0;  // two seconds of Walk at rest follow
  for (RunRow& row : record.rows) {
    if (row.t_s < stop_s || mode_of(row) != Mode::kWalk) continue;
    row.given = {};
    row.torque_nm.fill(0.0f);
  }
  draw_run_plot(record, folder_.path("stopped.png"));
  const Picture picture(folder_.path("stopped.png"));
  // Torques of the knees, in the narrow view: the dark lines of the right legs leave zero.
  constexpr int kTop_px = 80 + 4 * 174 + 34;
  int away_from_zero = 0;
  for (int y = kTop_px + 4; y < kTop_px + 136; ++y) {
    if (std::abs(y - (kTop_px + 70)) < 20) continue;
    for (int x = 1260; x < 1770; ++x) {
      const Rgb pixel = picture.at(x, y);
      away_from_zero += pixel.blue > pixel.red + 80 || pixel.red > pixel.blue + 80;
    }
  }
  EXPECT_GT(away_from_zero, 500);
}

TEST_F(RunPicturesTest, PicturesOfOddRunsAreDrawn) {
  RunRecord hills = trot(3.0, hilly, 0.0);
  hills.scene.terrain = "rigid";
  draw_run_strip(hills, folder_.path("hills_strip.png"));
  draw_run_plot(hills, folder_.path("hills_plot.png"));

  RunRecord fallen = trot(2.0, flat, kSinkage_m);
  RunRow last = fallen.rows.back();
  last.orientation_wxyz = {std::sqrt(0.5f), 0.5f, 0.5f, 0.0f};
  last.position_m[2] = 0.1;
  last.mode = static_cast<std::uint32_t>(Mode::kFault);
  for (int i = 1; i < 60; ++i) {
    last.t_s += 0.01;
    fallen.rows.push_back(last);
  }
  draw_run_strip(fallen, folder_.path("fallen_strip.png"));
  draw_run_plot(fallen, folder_.path("fallen_plot.png"));

  RunRecord one;
  one.rows.resize(1);
  RunRecord nothing;
  RunRecord stood;
  stood.rows.assign(hills.rows.begin(), hills.rows.begin() + 90);  // never in Walk
  RunRecord unknown = stood;
  for (RunRow& row : unknown.rows) row.motion[0] = std::numeric_limits<float>::quiet_NaN();
  for (const RunRecord& record : {one, nothing, stood, unknown}) {
    draw_run_strip(record, folder_.path("odd_strip.png"));
    draw_run_plot(record, folder_.path("odd_plot.png"));
    EXPECT_EQ(Picture(folder_.path("odd_strip.png")).width(), 1798);
    EXPECT_EQ(Picture(folder_.path("odd_plot.png")).width(), 1800);
  }
}

TEST_F(RunPicturesTest, UnwritablePathsAreNamed) {
  const RunRecord record;
  const std::string path = folder_.path("no such folder/file");
  for (const auto& write : {draw_run_plot, draw_run_strip, write_csv}) {
    try {
      write(record, path);
      ADD_FAILURE() << "no InputError";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(path + ": cannot be written ("), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace sandrunner
