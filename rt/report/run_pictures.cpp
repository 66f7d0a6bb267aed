// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rt/core/mode_machine.h"
#include "rt/plot/plot.h"
#include "rt/report/side_view.h"

namespace sandrunner {
namespace {

using plot::Color;

constexpr Color kBlue{0.12, 0.42, 0.75};
constexpr Color kOrange{0.90, 0.45, 0.05};
constexpr Color kTeal{0.05, 0.60, 0.50};
constexpr Color kGray{0.45, 0.48, 0.52};
constexpr Color kBlack = plot::kInk;
// Legs of a pair often move alike: left ones are wide and light, right ones narrow and dark on top.
constexpr std::array<Color, kNumLegs> kLegColors = {
    {{0.60, 0.79, 0.97}, {0.05, 0.30, 0.62}, {0.98, 0.76, 0.48}, {0.72, 0.30, 0.02}}};
constexpr double kLeftLeg_px = 4.5;

constexpr int kViews = 10;
constexpr int kViewsPerRow = 5;
constexpr double kGap_px = 8.0;
constexpr double kHead_px = 46.0;

std::string title_of(const RunRecord& record) {
  std::string title = record.scene.terrain.empty() ? std::string("Sandrunner")
                                                   : "Sandrunner on " + record.scene.terrain;
  if (!record.scene.policy.empty()) title += ", policy " + record.scene.policy;
  return title;
}

/// The rows to look at: from the first to the last in Walk; all of them if there is none.
struct Walk {
  std::size_t first = 0, last = 0;
};

Walk walk_of(const RunRecord& record) {
  const std::deque<RunRow>& rows = record.rows;
  const auto walks = [](const RunRow& row) { return mode_of(row) == Mode::kWalk; };
  const auto first = std::find_if(rows.begin(), rows.end(), walks);
  if (first == rows.end()) return {0, rows.empty() ? 0 : rows.size() - 1};
  const auto behind_last = std::find_if(rows.rbegin(), rows.rend(), walks).base();
  return {static_cast<std::size_t>(first - rows.begin()),
          static_cast<std::size_t>(behind_last - rows.begin()) - 1};
}

/// As RunRow::given.
using Command = std::array<float, 3>;

/// A second worth a closer look.
struct Detail {
  std::string title;
  double begin_s = 0.0, end_s = 0.0;
  std::optional<Command> command;  ///< if it is one all the time
};

double size_of(const Command& c) { return std::hypot(c[0], std::hypot(c[1], c[2])); }

/// The last second under the largest command that was held for one; the last of all if the walk did
/// not end in Stand, or none was held. Nothing for a shorter walk.
std::optional<Detail> detail_of(const RunRecord& record) {
  constexpr double kDetail_s = 1.0;
  const std::deque<RunRow>& rows = record.rows;
  if (rows.empty()) return std::nullopt;
  const Walk walk = walk_of(record);
  const RunRow& last = rows[walk.last];
  if (last.t_s - rows[walk.first].t_s <= kDetail_s) return std::nullopt;
  Detail detail{fmt::format("last second of {}", mode_name(mode_of(last))), last.t_s - kDetail_s,
                last.t_s, std::nullopt};
  double largest = -1.0;
  for (std::size_t i = walk.first, held = i; i <= walk.last; ++i) {
    const Command& command = rows[i].given;
    if (command != rows[held].given) held = i;
    if (rows[i].t_s - rows[held].t_s < kDetail_s || size_of(command) < largest) continue;
    largest = size_of(command);
    detail.command = command;
    detail.begin_s = rows[i].t_s - kDetail_s;
    detail.end_s = rows[i].t_s;
  }
  const bool ended_badly =
      walk.last + 1 < rows.size() && mode_of(rows[walk.last + 1]) != Mode::kStand;
  if (ended_badly || !detail.command) {
    detail.begin_s = last.t_s - kDetail_s;
    detail.end_s = last.t_s;
  } else {
    detail.title = "one second of steady gait";
  }
  return detail;
}

std::string command_text(const std::optional<Command>& c) {
  if (!c) return ", changing command";
  return fmt::format(", command {:.3g}, {:.3g} m/s, {:.3g} rad/s", (*c)[0], (*c)[1], (*c)[2]);
}

/// A series of `value(row)`.
template <typename Value>
plot::Series series(const RunRecord& record, const std::string& name, const Color& color,
                    const Value& value) {
  plot::Series result{name, color, {}};
  for (const RunRow& row : record.rows) result.y.push_back(value(row));
  return result;
}

/// A series of a commanded quantity: dashed steps.
template <typename Value>
plot::Series command(const RunRecord& record, const std::string& name, const Color& color,
                     const Value& value) {
  plot::Series result = series(record, name, color, value);
  result.step = true;
  result.dashed = true;
  return result;
}

/// Truth and estimate of the k-th number of the network's estimate.
std::vector<plot::Series> estimate(const RunRecord& record, std::size_t k) {
  return {series(record, "truth", kBlack, [k](const RunRow& row) { return row.truth[k]; }),
          series(record, "estimate", kOrange, [k](const RunRow& row) { return row.estimate[k]; })};
}

/// A series of `value(row, leg)` for each leg, the left one of a pair before the right one.
template <typename Value>
std::vector<plot::Series> leg_series(const RunRecord& record, const Value& value) {
  std::vector<plot::Series> all;
  for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
    all.push_back(series(record, record.scene.robot.leg_names[leg], kLegColors[leg],
                         [&](const RunRow& row) { return value(row, leg); }));
    if (leg % 2 == 0) all.back().width_px = kLeftLeg_px;
  }
  return all;
}

plot::Panel torque_panel(const RunRecord& record, const std::string& title, std::size_t joint) {
  return {title, "N m",
          leg_series(record,
                     [joint](const RunRow& row, std::size_t leg) {
                       return row.torque_nm[kJointsPerLeg * leg + joint];
                     }),
          10.0};
}

std::vector<plot::Panel> panels(const RunRecord& record) {
  const plot::Panel sinkage{"Sinkage of the feet", "mm",
                            leg_series(record,
                                       [](const RunRow& row, std::size_t leg) {
                                         const double depth_m = row.penetration_m[leg];
                                         return depth_m < 0.0 ? 0.0
                                                              : 1000.0 * depth_m;  // of NaN, NaN
                                       }),
                            10.0};
  return {
      {"Speed, heading frame",
       "m/s",
       {series(record, "vx", kBlue, [](const RunRow& row) { return row.motion[0]; }),
        series(record, "vy", kTeal, [](const RunRow& row) { return row.motion[1]; }),
        command(record, "vx commanded", kBlack, [](const RunRow& row) { return row.given[0]; }),
        command(record, "vy commanded", kGray, [](const RunRow& row) { return row.given[1]; })},
       0.5},
      {"Yaw rate",
       "rad/s",
       {series(record, "yaw rate", kBlue, [](const RunRow& row) { return row.motion[2]; }),
        command(record, "commanded", kBlack, [](const RunRow& row) { return row.given[2]; })},
       0.5},
      torque_panel(record, "Torque, hip abduction (HAA)", 0),
      torque_panel(record, "Torque, hip flexion (HFE)", 1),
      torque_panel(record, "Torque, knee (KFE)", 2),
      sinkage,
      {"Forward speed, body frame: estimate against truth", "m/s", estimate(record, 1), 0.5},
      {"Body height: estimate against truth", "m", estimate(record, 0), 0.1},
  };
}

/// The stretches of modes other than Walk, shaded.
std::vector<plot::Span> mode_spans(const RunRecord& record) {
  std::vector<plot::Span> spans;
  const std::deque<RunRow>& rows = record.rows;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t next = i;
    while (next < rows.size() && rows[next].mode == rows[i].mode) ++next;
    const double end_s = rows[std::min(next, rows.size() - 1)].t_s;
    Color color{0.955, 0.96, 0.97};
    if (mode_of(rows[i]) == Mode::kFault) color = {0.99, 0.90, 0.89};
    if (mode_of(rows[i]) == Mode::kWalk) color = {1.0, 1.0, 1.0};
    spans.push_back({rows[i].t_s, end_s, color, mode_name(mode_of(rows[i]))});
    i = next;
  }
  return spans;
}

}  // namespace

void draw_run_plot(const RunRecord& record, const std::string& png_path) {
  plot::Figure figure;
  figure.title = title_of(record);
  figure.x_label = "time, s";
  for (const RunRow& row : record.rows) figure.x.push_back(row.t_s);
  figure.panels = panels(record);
  figure.spans = mode_spans(record);
  figure.views = {{"", 0.0, 1.0, 0.68}};
  if (record.rows.size() > 1) figure.views[0] = {"", figure.x.front(), figure.x.back(), 0.68};
  if (const std::optional<Detail> detail = detail_of(record)) {
    figure.title += command_text(detail->command);
    figure.views.push_back({detail->title, detail->begin_s, detail->end_s, 0.32});
  }
  plot::draw(figure, png_path);
}

void draw_run_strip(const RunRecord& record, const std::string& png_path) {
  constexpr int kRows = kViews / kViewsPerRow;
  const plot::Canvas canvas(
      static_cast<int>(kGap_px + kViewsPerRow * (kSideViewWidth_px + kGap_px)),
      static_cast<int>(kHead_px + kRows * (kSideViewHeight_px + kGap_px)));
  const std::optional<Detail> detail = detail_of(record);
  const std::string title = title_of(record) + (detail ? command_text(detail->command) : "");
  canvas.text(kGap_px + 2.0, 30.0, title, 20.0, 0.0, plot::kInk, true);
  canvas.text(kGap_px + kViewsPerRow * (kSideViewWidth_px + kGap_px) - kGap_px, 30.0,
              "from the right, a little from behind; left legs light; below: metres walked", 14.0,
              1.0, plot::kFaintInk);
  const std::deque<RunRow>& rows = record.rows;
  const Walk walk = walk_of(record);
  std::vector<double> distance_m(rows.size(), 0.0);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    distance_m[i] = distance_m[i - 1] + rows[i].motion[0] * (rows[i].t_s - rows[i - 1].t_s);
  }
  for (std::size_t view = 0; view < kViews && !rows.empty(); ++view) {
    const std::size_t i = walk.first + (walk.last - walk.first) * view / (kViews - 1);
    const std::size_t row = view / kViewsPerRow;
    const std::size_t column = view % kViewsPerRow;
    const double left_px = kGap_px + static_cast<double>(column) * (kSideViewWidth_px + kGap_px);
    const double top_px = kHead_px + static_cast<double>(row) * (kSideViewHeight_px + kGap_px);
    draw_side_view(canvas, record, rows[i], distance_m[i] - distance_m[walk.first], left_px,
                   top_px);
  }
  canvas.save_png(png_path);
}

}  // namespace sandrunner
