// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_pictures.h"

#include <cairo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "rt/base/errors.h"
#include "rt/plot/plot.h"
#include "rt/report/run_csv.h"
#include "rt/report/run_record.h"

namespace sandrunner {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kRamp_s = 1.0;  // to full speed
constexpr double kSpeed_mps = 1.5;
constexpr double kStride_s = 0.4;
constexpr double kSinkage_m = 0.09;
constexpr double kLink_m = 0.24;

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / name;
}

/// Knee of a leg of two equal links, behind the line from hip to foot.
Vector3 knee_of(const Vector3& hip, const Vector3& foot) {
  const double dx = foot[0] - hip[0];
  const double dz = foot[2] - hip[2];
  const double length = std::hypot(dx, dz);
  const double off = std::sqrt(std::max(0.0, kLink_m * kLink_m - 0.25 * length * length));
  return {hip[0] + 0.5 * dx + off * dz / length, hip[1], hip[2] + 0.5 * dz - off * dx / length};
}

/// A made-up trot: stands for a second, runs for `walk_s`, stands again. Ground of height
/// `ground(x)`.
RunRecord trot(double walk_s, double (*ground)(double), double sinkage_m) {
  RunRecord record;
  record.scene.terrain = "dry-sand";
  record.scene.policy = "made-up";
  record.scene.granular_ground = sinkage_m > 0.0;
  record.scene.base_box_size_m = {0.7, 0.28, 0.12};
  record.scene.foot_radius_m = 0.03;
  for (std::size_t j = 0; j < kNumJoints; ++j) record.scene.joint_names[j] = kJointNames[j];
  for (std::size_t l = 0; l < kNumLegs; ++l) record.scene.leg_names[l] = kLegNames[l];
  record.scene.ground_height_m = [ground](double x, double) { return ground(x); };
  const double end_s = 1.0 + walk_s;
  double x = 0.0;
  std::array<bool, kNumLegs> was_down{};
  for (int i = 0; i <= std::lround((end_s + 0.5) * kPolicyHz); ++i) {
    RunSample s;
    s.t_s = static_cast<double>(i) / kPolicyHz;
    s.has_truth = true;
    const bool walks = s.t_s >= 1.0 && s.t_s <= end_s;
    s.mode = s.t_s < 0.6 ? Mode::kStandUp : walks ? Mode::kWalk : Mode::kStand;
    s.command = {walks ? kSpeed_mps : 0.0, 0.0, walks ? 0.2 : 0.0};
    const double phase = 2.0 * std::numbers::pi * (s.t_s - 1.0) / kStride_s;
    s.vx_mps =
        walks ? std::min(1.0, (s.t_s - 1.0) / kRamp_s) * 1.4 + 0.08 * std::sin(2.0 * phase) : 0.0;
    s.vy_mps = walks ? 0.05 * std::sin(phase) : 0.0;
    s.yaw_rate_radps = walks ? 0.2 + 0.3 * std::sin(phase) : 0.0;
    x += s.vx_mps / kPolicyHz;
    const double pitch = walks ? 0.05 * std::sin(2.0 * phase) : 0.0;
    s.orientation_wxyz = {std::cos(0.5 * pitch), 0.0, std::sin(0.5 * pitch), 0.0};
    s.base_position_m = {x, 0.0, ground(x) + 0.46 - (walks ? sinkage_m : 0.0)};
    s.has_estimate = walks;
    s.truth.velocity_mps = {s.vx_mps, s.vy_mps, 0.0};
    s.truth.body_height_m = s.base_position_m[2] - ground(x);
    s.estimate = s.truth;
    s.estimate.velocity_mps[0] += 0.05 * std::sin(7.0 * s.t_s);
    s.estimate.body_height_m += 0.02 + 0.01 * std::sin(5.0 * s.t_s);
    for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
      const double side = leg % 2 == 0 ? 1.0 : -1.0;
      const double front = leg < 2 ? 1.0 : -1.0;
      const double swing = phase + (side * front > 0.0 ? 0.0 : std::numbers::pi);
      const double lift_m = walks ? 0.09 * std::sin(swing) : 0.0;
      const Vector3 hip = {x + 0.3072 * front, 0.169 * side, s.base_position_m[2] - 0.036};
      Vector3 foot = {hip[0] - (walks ? 0.1 * s.vx_mps * std::cos(swing) : 0.0), hip[1], 0.0};
      const double height = ground(foot[0]);
      const double depth_m = walks ? sinkage_m * std::max(0.0, -std::sin(swing)) : 0.0;
      foot[2] = height + 0.0295 + std::max(0.0, lift_m) - depth_m;
      s.hip_position_m[leg] = hip;
      s.foot_position_m[leg] = foot;
      s.knee_position_m[leg] = knee_of(hip, foot);
      s.ground_height_m[leg] = height;
      s.penetration_m[leg] = lift_m > 0.0 ? -lift_m : depth_m;
      s.contact[leg] = s.penetration_m[leg] >= 0.0;
      if (was_down[leg] && !s.contact[leg] && sinkage_m > 0.0) {
        record.footprints.push_back({s.t_s, foot[0], foot[1], sinkage_m});
      }
      was_down[leg] = s.contact[leg];
      for (std::size_t joint = 0; joint < 3; ++joint) {
        s.joint_torque_nm[3 * leg + joint] =
            walks ? 12.0 * (1.0 + static_cast<double>(joint)) *
                        std::sin(swing + 0.4 * static_cast<double>(joint))
                  : 5.0;
      }
    }
    record.samples.push_back(s);
  }
  return record;
}

double flat(double) { return 0.0; }
double hilly(double x) { return 0.06 * std::sin(4.0 * x); }

struct Rgb {
  int red = 0, green = 0, blue = 0;
  bool operator==(const Rgb&) const = default;
};

/// A PNG from a file, by cairo's reader.
class Picture {
 public:
  explicit Picture(const std::filesystem::path& path)
      : surface_(cairo_image_surface_create_from_png(path.c_str())) {
    EXPECT_EQ(cairo_surface_status(surface_), CAIRO_STATUS_SUCCESS) << path;
  }
  ~Picture() { cairo_surface_destroy(surface_); }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  int width() const { return cairo_image_surface_get_width(surface_); }
  int height() const { return cairo_image_surface_get_height(surface_); }
  Rgb at(int x, int y) const {
    const unsigned char* row =
        cairo_image_surface_get_data(surface_) + y * cairo_image_surface_get_stride(surface_);
    std::uint32_t pixel = 0;
    std::memcpy(&pixel, row + 4 * x, 4);
    return {static_cast<int>(pixel >> 16 & 0xff), static_cast<int>(pixel >> 8 & 0xff),
            static_cast<int>(pixel & 0xff)};
  }
  /// How many pixels of the rectangle have the colour, but for rounding.
  int count(const plot::Color& color, int left, int top, int right, int bottom) const {
    int found = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        const Rgb pixel = at(x, y);
        found += std::abs(pixel.red - color.red * 255.0) < 3.0 &&
                 std::abs(pixel.green - color.green * 255.0) < 3.0 &&
                 std::abs(pixel.blue - color.blue * 255.0) < 3.0;
      }
    }
    return found;
  }

 private:
  cairo_surface_t* surface_;
};

TEST(PlotTest, TicksAreRoundNumbersWithinTheRange) {
  EXPECT_EQ(plot::ticks(0.0, 1.0, 6), (std::vector<double>{0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_EQ(plot::ticks(0.0, 1.0, 5), (std::vector<double>{0.0, 0.5, 1.0}));
  EXPECT_EQ(plot::ticks(-63.0, 63.0, 5), (std::vector<double>{-50.0, 0.0, 50.0}));
  EXPECT_EQ(plot::ticks(19.0, 20.0, 4), (std::vector<double>{19.0, 19.5, 20.0}));
  EXPECT_EQ(plot::ticks(0.0011, 0.0019, 4), (std::vector<double>{0.0012, 0.0014, 0.0016, 0.0018}));
  EXPECT_TRUE(plot::ticks(1.0, 1.0, 5).empty());
  EXPECT_TRUE(plot::ticks(0.0, kNan, 5).empty());
  for (double span = 1e-4; span < 1e6; span *= 1.37) {
    const double begin = -0.3 * span;
    const std::vector<double> found = plot::ticks(begin, begin + span, 7);
    ASSERT_GE(found.size(), 2U) << span;
    ASSERT_LE(found.size(), 7U) << span;
    EXPECT_GE(found.front(), begin - 1e-9 * span);
    EXPECT_LE(found.back(), begin + span * (1.0 + 1e-9));
  }
}

TEST(PlotTest, TickLabelsHaveTheDigitsOfTheStep) {
  EXPECT_EQ(plot::tick_label(0.2, 0.2), "0.2");
  EXPECT_EQ(plot::tick_label(1.0, 0.05), "1.00");
  EXPECT_EQ(plot::tick_label(-50.0, 50.0), "\u221250");
  EXPECT_EQ(plot::tick_label(-0.0, 1.0), "0");
}

TEST(PlotTest, DecimationKeepsPeaksOfOneSampleAndGaps) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 100000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(0.001 * i));
  }
  y[12345] = 9.0;
  y[12347] = -9.0;
  y[70000] = kNan;
  const std::vector<plot::Point> points = plot::decimate(x, y, 0.0, 99999.0, 500);
  EXPECT_LE(points.size(), 4U * 502U + 3U);
  const auto has = [&](double at, double value) {
    return std::any_of(points.begin(), points.end(),
                       [&](const plot::Point& p) { return p.x == at && p.y == value; });
  };
  EXPECT_TRUE(has(12345.0, 9.0));
  EXPECT_TRUE(has(12347.0, -9.0));
  EXPECT_EQ(std::count_if(points.begin(), points.end(),
                          [](const plot::Point& p) { return std::isnan(p.y); }),
            1);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end(),
                             [](const plot::Point& a, const plot::Point& b) { return a.x < b.x; }));
  // With fewer samples than pixels all are kept, and the neighbours outside.
  EXPECT_EQ(plot::decimate(x, y, 10.5, 20.5, 500).size(), 12U);
}

TEST(PlotTest, DrawnPeakOfOneSampleReachesItsHeight) {
  plot::Figure figure;
  const plot::Color red{1.0, 0.0, 0.0};
  plot::Panel panel{"peak", "m", {{"", red, {}, false, false}}};
  for (int i = 0; i < 50000; ++i) {
    figure.x.push_back(i);
    panel.series[0].y.push_back(i == 20000 ? 1.0 : 0.0);
  }
  figure.panels = {panel};
  figure.views = {{"", 0.0, 49999.0, 1.0}};
  figure.width_px = 700;
  const std::filesystem::path path = temporary("peak.png");
  plot::draw(figure, path);
  const Picture picture(path);
  // Reddish pixels in the upper half of the panel, right of the axis and left of the legend.
  int reddish = 0;
  for (int y = 110; y < 165; ++y) {
    for (int x = 110; x < 600; ++x) {
      const Rgb pixel = picture.at(x, y);
      reddish += pixel.red > pixel.green + 60;
    }
  }
  EXPECT_GE(reddish, 40);
}

TEST(RunPicturesTest, PlotShowsEverySeriesOfEveryPanel) {
  const std::filesystem::path path = temporary("run_plot.png");
  draw_run_plot(trot(8.0, flat, kSinkage_m), path);
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
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

TEST(RunPicturesTest, StripShowsTheRobotInEveryViewAndItsFootprints) {
  RunRecord record = trot(8.0, flat, kSinkage_m);
  const std::filesystem::path path = temporary("run_strip.png");
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
  const std::filesystem::path bare_path = temporary("run_strip_without_footprints.png");
  draw_run_strip(record, bare_path);
  const Picture bare(bare_path);
  const auto sand = [](const Picture& p) {  // in the last view
    return p.count({0.90, 0.80, 0.60}, 1440, 312, 1790, 570);
  };
  EXPECT_LT(sand(picture), sand(bare) - 1000);
}

TEST(RunPicturesTest, PicturesOfOddRunsAreDrawn) {
  RunRecord hills = trot(3.0, hilly, 0.0);
  hills.scene.terrain = "rigid";
  draw_run_strip(hills, temporary("hills_strip.png"));
  draw_run_plot(hills, temporary("hills_plot.png"));

  RunRecord fallen = trot(2.0, flat, kSinkage_m);
  RunSample last = fallen.samples.back();
  last.orientation_wxyz = {std::sqrt(0.5), 0.5, 0.5, 0.0};
  last.base_position_m[2] = 0.1;
  last.mode = Mode::kFault;
  for (int i = 1; i < 60; ++i) {
    last.t_s += 0.01;
    fallen.samples.push_back(last);
  }
  draw_run_strip(fallen, temporary("fallen_strip.png"));
  draw_run_plot(fallen, temporary("fallen_plot.png"));

  RunRecord one;
  one.samples.resize(1);
  RunRecord nothing;
  RunRecord stood;
  stood.samples.assign(hills.samples.begin(), hills.samples.begin() + 90);  // never in Walk
  RunRecord unknown = stood;
  for (RunSample& sample : unknown.samples) sample.vx_mps = kNan;
  for (const RunRecord& record : {one, nothing, stood, unknown}) {
    draw_run_strip(record, temporary("odd_strip.png"));
    draw_run_plot(record, temporary("odd_plot.png"));
    EXPECT_EQ(Picture(temporary("odd_strip.png")).width(), 1798);
    EXPECT_EQ(Picture(temporary("odd_plot.png")).width(), 1800);
  }
}

TEST(RunPicturesTest, UnwritablePathsAreNamed) {
  const RunRecord record;
  const std::string path = temporary("no such folder") / "file";
  for (const auto& write : {draw_run_plot, draw_run_strip, write_csv}) {
    try {
      write(record, path);
      ADD_FAILURE() << "no InputError";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(path + ": cannot be written ("), 0U) << error.what();
    }
  }
}

TEST(RunCsvTest, EveryRowHasAValueForEveryColumn) {
  const RunRecord record = trot(1.0, flat, kSinkage_m);
  const std::filesystem::path path = temporary("run.csv");
  write_csv(record, path);
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".part"));
  std::ifstream file(path);
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const std::vector<std::string> columns = csv_columns(record.scene);
  std::string header;
  for (const std::string& column : columns) header += (header.empty() ? "" : ",") + column;
  EXPECT_EQ(line, header);
  // Time, mode, command 3, pose 7, speed 3, joints 36, 12 a leg, estimate and truth 8 each.
  EXPECT_EQ(columns.size(), 2U + 3U + 7U + 3U + 36U + 4U * 12U + 16U);
  std::vector<std::string> sorted = columns;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
  std::size_t rows = 0;
  while (std::getline(file, line)) {
    EXPECT_EQ(static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1,
              columns.size());
    if (rows == 0) {
      EXPECT_EQ(line.find("0,stand_up,0,0,0,0,0,0.46,1,0,0,0,"), 0U) << line;
      EXPECT_NE(line.find(",nan,nan,"), std::string::npos) << line;
    } else if (rows == 150) {
      EXPECT_EQ(line.find("1.5,walk,1.5,0,0.2,"), 0U) << line;
    }
    ++rows;
  }
  EXPECT_EQ(rows, record.samples.size());
}

}  // namespace
}  // namespace sandrunner
