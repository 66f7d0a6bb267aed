// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "rt/base/output_files.h"

namespace sandrunner::train {
namespace {

using R = const ProgressRow&;

struct Column {
  const char* name;
  double (*value)(R row);
};

// The terms of the reward follow, each as reward_<name> or penalty_<name>.
constexpr Column kColumns[] = {
    {"iteration", [](R r) { return r.iteration; }},
    {"transitions", [](R r) { return r.transitions; }},
    {"core_hours", [](R r) { return r.core_hours; }},
    {"transitions_per_s", [](R r) { return r.transitions_per_s; }},
    {"simulation_share", [](R r) { return r.simulation_share; }},
    {"reward", [](R r) { return r.window.reward; }},
    {"kernel_rigid", [](R r) { return r.window.kernel[0]; }},
    {"kernel_soil", [](R r) { return r.window.kernel[1]; }},
    {"falls_rigid_per_4s", [](R r) { return r.window.falls[0]; }},
    {"falls_soil_per_4s", [](R r) { return r.window.falls[1]; }},
    {"speed_ratio_rigid", [](R r) { return r.window.speed_ratio[0]; }},
    {"speed_ratio_soil", [](R r) { return r.window.speed_ratio[1]; }},
    {"estimate_vx_rms_mps", [](R r) { return r.estimate_vx_rms_mps; }},
    {"estimate_height_rms_m", [](R r) { return r.estimate_height_rms_m; }},
    {"command_speed_mps", [](R r) { return r.command_speed_mps; }},
    {"ground_open", [](R r) { return r.ground_open; }},
    {"battery_alive", [](R r) { return r.battery.alive; }},
    {"battery_error", [](R r) { return r.battery.error; }},
    {"battery_cost_of_transport", [](R r) { return r.battery.cost_of_transport; }},
    {"battery_too_fast", [](R r) { return r.battery.too_fast; }},
    {"battery_drift_mps", [](R r) { return r.battery.drift_mps; }},
    {"battery_yaw_drift_radps", [](R r) { return r.battery.yaw_drift_radps; }},
    {"battery_score", [](R r) { return r.score; }},
    {"battery_alive_1", [](R r) { return r.battery.alive_at[0]; }},
    {"battery_alive_2", [](R r) { return r.battery.alive_at[1]; }},
    {"battery_alive_3", [](R r) { return r.battery.alive_at[2]; }},
    {"battery_alive_4", [](R r) { return r.battery.alive_at[3]; }},
    {"battery_alive_5", [](R r) { return r.battery.alive_at[4]; }},
    {"battery_cost_1", [](R r) { return r.battery.cost_of_transport_at[0]; }},
    {"battery_cost_2", [](R r) { return r.battery.cost_of_transport_at[1]; }},
    {"battery_cost_3", [](R r) { return r.battery.cost_of_transport_at[2]; }},
    {"battery_cost_4", [](R r) { return r.battery.cost_of_transport_at[3]; }},
    {"battery_cost_5", [](R r) { return r.battery.cost_of_transport_at[4]; }},
    {"battery_share", [](R r) { return r.battery_share; }},
    {"late_penalties", [](R r) { return r.late; }},
    {"settled", [](R r) { return r.settled; }},
    {"body_height_m", [](R r) { return r.window.body_height_m; }},
    {"torque_squared_nm2", [](R r) { return r.window.torque_squared; }},
    {"power_w", [](R r) { return r.window.power_w; }},
    {"stride_hz", [](R r) { return r.window.stride_hz; }},
    {"abreast", [](R r) { return r.window.abreast; }},
    {"diagonal", [](R r) { return r.window.diagonal; }},
    {"learning_rate", [](R r) { return r.learning_rate; }},
    {"kl", [](R r) { return r.kl; }},
    {"action_std", [](R r) { return r.action_std; }},
    {"asymmetry", [](R r) { return r.asymmetry; }},
    {"explained_variance", [](R r) { return r.explained_variance; }},
    {"imitation_rms", [](R r) { return r.imitation_rms; }},
    {"encoding_rms", [](R r) { return r.encoding_rms; }},
};

// What is drawn together, columns by their names in curve.csv.
struct Panel {
  const char* title;
  const char* unit;
  struct Line {
    const char* name;
    const char* column;
  };
  std::array<Line, 2> lines;  // the second may have no name
};
constexpr Panel kPanels[] = {
    {"Battery: runs without a fall",
     "share",
     {{{"all", "battery_alive"}, {"fastest forward", "battery_alive_5"}}}},
    {"Battery: tracking error", "of the command", {{{"error", "battery_error"}}}},
    {"Battery: cost of transport", "forward", {{{"mean", "battery_cost_of_transport"}}}},
    {"Battery: a joint too fast", "share of time", {{{"too fast", "battery_too_fast"}}}},
    {"Late penalties and settling",
     "share",
     {{{"late penalties", "late_penalties"}, {"settled", "settled"}}}},
    {"Reward", "a step", {{{"reward", "reward"}}}},
    {"Velocity tracking", "kernel, 0 to 1", {{{"rigid", "kernel_rigid"}, {"soil", "kernel_soil"}}}},
    {"Falls",
     "per robot and 4 s",
     {{{"rigid", "falls_rigid_per_4s"}, {"soil", "falls_soil_per_4s"}}}},
    {"Gait: strides", "Hz", {{{"stride", "stride_hz"}}}},
    {"Gait: feet together in the air",
     "correlation",
     {{{"diagonal", "diagonal"}, {"side by side", "abreast"}}}},
    {"Curricula",
     "m/s; 0 to 1",
     {{{"commanded speed", "command_speed_mps"}, {"softness of the ground", "ground_open"}}}},
    {"Estimator",
     "rms error",
     {{{"vx, m/s", "estimate_vx_rms_mps"}, {"body height, m", "estimate_height_rms_m"}}}},
};
constexpr const char* kAbscissa = "million transitions";

// A column of curve.csv.
struct Series {
  std::string name;
  std::vector<double> values;
};

std::vector<Series> series_of(const std::vector<ProgressRow>& rows) {
  std::vector<Series> all;
  for (const Column& column : kColumns) {
    Series series{column.name, {}};
    for (const ProgressRow& row : rows) series.values.push_back(column.value(row));
    all.push_back(std::move(series));
  }
  const std::vector<std::string> terms = reward_term_names();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Series series{terms[i], {}};
    for (const ProgressRow& row : rows) series.values.push_back(row.window.terms[i]);
    all.push_back(std::move(series));
  }
  return all;
}

const std::vector<double>& values_of(const std::vector<Series>& all, std::string_view name) {
  return std::ranges::find(all, name, &Series::name)->values;
}

std::vector<double> millions(const std::vector<ProgressRow>& rows) {
  std::vector<double> x;
  for (const ProgressRow& row : rows) x.push_back(row.transitions / 1e6);
  return x;
}

// Means of every N values, as a list of JSON.
std::string json_list(const std::vector<double>& values, std::size_t every) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); i += every) {
    const std::size_t end = std::min(values.size(), i + every);
    double sum = 0.0;
    for (std::size_t k = i; k < end; ++k) sum += values[k];
    const double mean = sum / static_cast<double>(end - i);
    text += text.empty() ? "" : ",";
    text += std::isfinite(mean) ? fmt::format("{:.5g}", mean) : "null";
  }
  return fmt::format("[{}]", text);
}

}  // namespace

double Progress::most_alive() const {
  double most = 0.0;
  for (const ProgressRow& row : rows_) most = std::max(most, row.battery.alive);
  return most;
}

void Progress::save(learner::Checkpoint& checkpoint) const {
  const std::uint64_t count = rows_.size();
  checkpoint.put("progress.count", &count, 1);
  checkpoint.put("progress.rows", rows_.data(), rows_.size());
}

void Progress::load(const learner::Checkpoint& checkpoint) {
  std::uint64_t count = 0;
  checkpoint.get("progress.count", &count, 1);
  rows_.resize(count);
  checkpoint.get("progress.rows", rows_.data(), rows_.size());
}

std::string Progress::line(const ProgressRow& r, double eta_s) {
  const WindowStats& w = r.window;
  return fmt::format(
      "{:5.1f} M {:3.0f} k/s {:4.1f} Hz trot {:+.2f} alive {:.2f} error {:.2f} cost {:.2f} "
      "fast {:.3f} late {:.2f} {:3.0f} min left",
      r.transitions / 1e6, r.transitions_per_s / 1e3, w.stride_hz, w.diagonal, r.battery.alive,
      r.battery.error, r.battery.cost_of_transport, r.battery.too_fast, r.late,
      std::max(eta_s, 0.0) / 60.0);
}

std::string Progress::summary(const BatteryFigures& f) {
  return fmt::format(
      "alive {:.3f}, error {:.3f}, cost of transport {:.3f}, too fast {:.4f}, drift "
      "{:.3f} m/s and {:.3f} rad/s",
      f.alive, f.error, f.cost_of_transport, f.too_fast, f.drift_mps, f.yaw_drift_radps);
}

const char* Progress::explanation() {
  return "A line of progress. Of the last update's steps:\n"
         "  M        transitions so far, millions; a transition is 10 ms of one robot\n"
         "  k/s      transitions a second, thousands\n"
         "  Hz       strides a second\n"
         "  trot     correlation of diagonal feet in the air: 1 is a trot, below 0 they alternate\n"
         "Of the latest battery, a fixed set of runs of the averaged policy without noise or "
         "pushes:\n"
         "  alive    share of the runs without a fall\n"
         "  error    of the steady velocity, relative to the commanded one\n"
         "  cost     cost of transport, mean over the forward speeds\n"
         "  fast     share of time in which a joint is above its speed limit\n"
         "And of the schedule:\n"
         "  late     share of the late penalties: rises while the battery is passed\n"
         "  min left minutes to the end, at the pace so far\n"
         "curve.csv has a row for each update: all of these, the battery's figures for each\n"
         "forward speed (battery.forward_share, slowest first), reward, tracking and falls under\n"
         "noise and pushes, and each term of the reward by its name (reward_..., penalty_...);\n"
         "curve.html draws what was measured and, in 3D, a run of the policy as it is;\n"
         "tools/pictures.py draws the most telling ones as curve.png.\n";
}

void Progress::write(const std::string& dir) const {
  const std::vector<Series> all = series_of(rows_);
  std::string csv;
  for (const Series& s : all) csv += fmt::format("{}{}", csv.empty() ? "" : ",", s.name);
  csv += "\n";
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (const Series& s : all) {
      csv += fmt::format("{}{:.6g}", &s == &all.front() ? "" : ",", s.values[row]);
    }
    csv += "\n";
  }
  write_file(dir + "/curve.csv", csv);
}

std::string Progress::page_json(const std::string& title) const {
  constexpr std::size_t kMostPoints = 1000;
  const std::size_t every = (rows_.size() + kMostPoints - 1) / kMostPoints;
  const std::vector<Series> all = series_of(rows_);
  std::set<std::string_view> drawn = {"iteration", "transitions"};
  std::string charts;
  const auto add = [&](std::string_view name, std::string_view unit, const std::string& lines) {
    charts += fmt::format(R"({}{{"title":"{}","unit":"{}","lines":[{}]}})",
                          charts.empty() ? "" : ",", name, unit, lines);
  };
  const auto line = [&](std::string_view name, std::string_view column) {
    drawn.insert(column);
    return fmt::format(R"({{"name":"{}","values":{}}})", name,
                       json_list(values_of(all, column), every));
  };
  for (const Panel& panel : kPanels) {
    std::string lines = line(panel.lines[0].name, panel.lines[0].column);
    if (panel.lines[1].name) {
      lines.append(",").append(line(panel.lines[1].name, panel.lines[1].column));
    }
    add(panel.title, panel.unit, lines);
  }
  // The terms of the reward come first; they are the last columns.
  std::vector<std::string> names = reward_term_names();
  for (const Series& series : all) names.push_back(series.name);
  for (const std::string& name : names) {
    const std::vector<double>& values = values_of(all, name);
    const bool measured = std::ranges::any_of(values, [](double v) { return std::isfinite(v); });
    if (measured && !drawn.contains(name)) add(name, "", line("", name));
  }
  return fmt::format(R"({{"title":{},"x_label":"{}","x":{},"every":{},"charts":[{}]}})",
                     nlohmann::json(title).dump(), kAbscissa, json_list(millions(rows_), every),
                     every, charts);
}

}  // namespace sandrunner::train
