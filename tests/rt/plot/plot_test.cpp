// SPDX-License-Identifier: BSD-3-Clause
#include "rt/plot/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/rt/plot/picture.h"
#include "tests/support/not_finite.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

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

TEST(PlotTest, TicksEndWhereAStepMoreIsNoOtherNumber) {
  for (const double begin : {2e15, 1e17, -1e300, 1e308}) {
    EXPECT_LE(plot::ticks(begin, begin + 1.0, 7).size(), 7U) << begin;
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
  const TemporaryFolder folder;
  plot::draw(figure, folder.path("peak.png"));
  const Picture picture(folder.path("peak.png"));
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

}  // namespace
}  // namespace sandrunner
