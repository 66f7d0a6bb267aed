// SPDX-License-Identifier: BSD-3-Clause
#include "rt/plot/chart.h"

#include <gtest/gtest.h>

#include "rt/plot/heat_map.h"
#include "tests/rt/plot/picture.h"
#include "tests/support/not_finite.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

constexpr plot::Color kRed{1.0, 0.0, 0.0}, kBlue{0.0, 0.0, 1.0};
// Where the one chart of a page of this size has its values.
constexpr int kWidth_px = 600, kHeight_px = 400;
constexpr int kLeft_px = 72, kRight_px = 572, kTop_px = 38, kBottom_px = 358;

class ChartTest : public testing::Test {
 protected:
  Picture draw(plot::Chart chart) const {
    plot::ChartPage page;
    page.columns = 1;
    page.width_px = kWidth_px;
    page.chart_height_px = kHeight_px;
    page.charts = {std::move(chart)};
    plot::draw_charts(page, folder_.path("chart.png"));
    return Picture(folder_.path("chart.png"));
  }
  static int x_px(double share) {
    return static_cast<int>(kLeft_px + share * (kRight_px - kLeft_px));
  }
  static int y_px(double share) {
    return static_cast<int>(kBottom_px + share * (kTop_px - kBottom_px));
  }
  static plot::Chart unit_chart() {
    plot::Chart chart;
    chart.x_begin = chart.y_begin = 0.0;
    chart.x_end = chart.y_end = 1.0;
    return chart;
  }
  static bool has_near(const Picture& picture, const plot::Color& color, int x, int y) {
    return picture.count(color, x - 3, y - 3, x + 4, y + 4) > 4;
  }
  const TemporaryFolder folder_;
};

TEST_F(ChartTest, EachSeriesHasAnXAxisOfItsOwn) {
  plot::Chart chart = unit_chart();
  chart.series.push_back({"", {kRed}, {0.25}, {0.5}, {}, {}, false, true});
  chart.series.push_back({"", {kBlue}, {0.1, 0.75}, {kNan, 0.5}, {}, {}, false, true});
  const Picture picture = draw(chart);
  EXPECT_TRUE(has_near(picture, kRed, x_px(0.25), y_px(0.5)));
  EXPECT_TRUE(has_near(picture, kBlue, x_px(0.75), y_px(0.5)));
  EXPECT_FALSE(has_near(picture, kRed, x_px(0.75), y_px(0.5)));
  EXPECT_EQ(picture.count(kBlue, x_px(0.0), kTop_px, x_px(0.5), kBottom_px), 0);
}

TEST_F(ChartTest, BarsOfTwoSeriesStandNextToEachOtherFromZero) {
  plot::Chart chart = unit_chart();
  chart.categories = {"one"};
  chart.series.push_back({"", {kRed}, {0.0}, {0.5}, {}, {}, false, false, true});
  chart.series.push_back({"", {kBlue}, {0.0}, {0.25}, {}, {}, false, false, true});
  const Picture picture = draw(chart);
  EXPECT_EQ(picture.at(x_px(0.3), y_px(0.4)), (Rgb{255, 0, 0}));
  EXPECT_NE(picture.at(x_px(0.3), y_px(0.6)), (Rgb{255, 0, 0}));
  EXPECT_EQ(picture.at(x_px(0.7), y_px(0.2)), (Rgb{0, 0, 255}));
  EXPECT_NE(picture.at(x_px(0.7), y_px(0.4)), (Rgb{0, 0, 255}));
}

TEST_F(ChartTest, CapsReachFromTheLowToTheHighEnd) {
  plot::Chart chart = unit_chart();
  chart.series.push_back({"", {kRed}, {0.5}, {0.5}, {0.2}, {0.8}, false});
  const Picture picture = draw(chart);
  const auto reddish = [&](double y) {
    int found = 0;
    for (int x = x_px(0.5) - 10; x < x_px(0.5) + 10; ++x) {
      const Rgb pixel = picture.at(x, y_px(y));
      found += pixel.red > pixel.green + 60;
    }
    return found;
  };
  EXPECT_GT(reddish(0.25), 0);
  EXPECT_GT(reddish(0.75), 0);
  EXPECT_EQ(reddish(0.9), 0);
  EXPECT_EQ(reddish(0.1), 0);
}

TEST_F(ChartTest, ABandIsShadedBetweenItsEnds) {
  plot::Chart chart = unit_chart();
  chart.series.push_back(
      {"", {kRed}, {0.0, 1.0}, {0.5, 0.5}, {0.3, 0.3}, {0.7, 0.7}, false, false, false, true});
  const Picture picture = draw(chart);
  const auto shaded = [&](double y) {
    const Rgb pixel = picture.at(x_px(0.53), y_px(y));
    return pixel.red - pixel.green > 20;
  };
  EXPECT_TRUE(shaded(0.45));
  EXPECT_FALSE(shaded(0.85));
  EXPECT_FALSE(shaded(0.15));
}

TEST_F(ChartTest, ADashedLineHasGaps) {
  plot::Chart chart = unit_chart();
  chart.series.push_back({"", {kRed, {8.0, 8.0}}, {0.0, 1.0}, {0.45, 0.45}});
  const Picture picture = draw(chart);
  const int count = picture.count(kRed, kLeft_px, y_px(0.45) - 1, kRight_px, y_px(0.45) + 2);
  EXPECT_GT(count, (kRight_px - kLeft_px) / 4);
  EXPECT_LT(count, 2 * (kRight_px - kLeft_px));
}

TEST_F(ChartTest, AnAxisHoldsAllValuesWithTheirCaps) {
  plot::Chart chart;
  chart.series.push_back(
      {"", {kRed}, {1.0, 3.0}, {10.0, 20.0}, {10.0, 5.0}, {10.0, 40.0}, false, true});
  const Picture picture = draw(chart);
  EXPECT_GT(picture.count(kRed, kLeft_px, kTop_px, kRight_px, kBottom_px), 40);
}

TEST(HeatMapTest, CellsLieColumnByColumnFromTheBottomUp) {
  plot::HeatMap map;
  map.values = {0.0, 1.0, kNan, 0.0};
  map.column_labels = {"a", "b"};
  map.row_labels = {"c", "d"};
  const TemporaryFolder folder;
  const plot::Canvas canvas(200, 150);
  plot::draw_map(canvas, map, 50.0, 40.0);
  canvas.save_png(folder.path("map.png"));
  const Picture picture(folder.path("map.png"));
  const auto corner = [&](int column, int row) {  // beside the value
    return picture.at(53 + 47 * column, 43 + 26 * row);
  };
  EXPECT_EQ(corner(0, 1), (Rgb{255, 255, 217}));
  EXPECT_EQ(corner(0, 0), (Rgb{33, 94, 168}));
  EXPECT_EQ(corner(1, 1), (Rgb{51, 51, 51}));
  EXPECT_EQ(corner(1, 0), (Rgb{255, 255, 217}));
}

}  // namespace
}  // namespace sandrunner
