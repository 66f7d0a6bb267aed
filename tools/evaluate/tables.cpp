// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rt/base/fixed_text.h"

namespace sandrunner::evaluate {
namespace {

// Rows of cells as columns of equal width, the first `left` of them to the left.
class Table {
 public:
  explicit Table(std::size_t left) : left_(left) {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string text() const {
    std::vector<std::size_t> width;
    for (const auto& row : rows_) {
      width.resize(std::max(width.size(), row.size()));
      for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    }
    std::string out;
    for (const auto& row : rows_) {
      std::string line = " ";
      for (std::size_t i = 0; i < row.size(); ++i) {
        line += i < left_ ? fmt::format(" {:<{}}", row[i], width[i])
                          : fmt::format("  {:>{}}", row[i], width[i]);
      }
      line.erase(line.find_last_not_of(' ') + 1);
      out += line + "\n";
    }
    return out;
  }

 private:
  std::size_t left_;
  std::vector<std::vector<std::string>> rows_;
};

// "15/16 [72,99]" (in percent), "1.02+-0.01", or without intervals "1.02".
std::string cell(const Metric& m, const std::vector<TrialFigures>& runs, bool with_interval) {
  const Estimate e = pool(m, runs);
  if (e.n == 0) return "-";
  if (m.pooling == Pooling::kRate) {
    return fmt::format("{:.0f}/{} [{:.0f},{:.0f}]", e.value * e.n, e.n, 100 * e.low, 100 * e.high);
  }
  const double half = 0.5 * (e.high - e.low) * m.table_scale;
  if (e.n == 1 || !with_interval) return fixed_text(e.value * m.table_scale, m.digits);
  return fmt::format("{}+-{}", fixed_text(e.value * m.table_scale, m.digits),
                     fixed_text(half, m.digits));
}

std::string command_text(const VelocityCommand& c) {
  if (c.vx_mps == 0.0 && c.vy_mps == 0.0 && c.wz_radps == 0.0) return "0";
  if (c.wz_radps != 0.0) return fmt::format("wz {:.1f}", c.wz_radps);
  if (c.vy_mps != 0.0) return fmt::format("vy {:.1f}", c.vy_mps);
  return fmt::format("{:.1f}", c.vx_mps);
}

// One row a group and policy.
std::string group_table(const PartResults& results, const std::vector<std::string>& policies,
                        const std::vector<std::string>& keys, bool with_scenario,
                        bool with_interval = true) {
  Table table(with_scenario ? 4 : 3);
  std::vector<std::string> head = {"ground"};
  if (with_scenario) head.push_back("scenario");
  head.insert(head.end(), {"command", "policy"});
  for (const std::string& key : keys) head.push_back(metric(key).heading);
  table.add(head);
  for (std::size_t g = 0; g < results.part.groups.size(); ++g) {
    const Group& group = results.part.groups[g];
    for (std::size_t p = 0; p < policies.size(); ++p) {
      std::vector<std::string> row = {p == 0 ? group.ground : ""};
      if (with_scenario) row.push_back(p == 0 ? group.scenario : "");
      row.insert(row.end(), {p == 0 ? command_text(group.command) : "", policies[p]});
      for (const std::string& key : keys)
        row.push_back(cell(metric(key), results.runs[p][g], with_interval));
      table.add(row);
    }
  }
  return table.text();
}

// Cost of transport of the first policy at the steady speeds of the second.
std::string cot_at_same_speed(const PartResults& results,
                              const std::vector<std::string>& policies) {
  Table table(2);
  table.add({"ground", "command", "m/s", policies[1], policies[0], "ratio"});
  const auto point = [&](std::size_t p, std::size_t g) {
    return std::pair{pool(metric("vx_mps"), results.runs[p][g]).value,
                     pool(metric("cot"), results.runs[p][g]).value};
  };
  for (std::size_t g = 0; g < results.part.groups.size(); ++g) {
    const Group& group = results.part.groups[g];
    const auto [speed, cot] = point(1, g);
    if (std::isnan(speed)) continue;
    std::vector<std::pair<double, double>> points;
    for (std::size_t k = 0; k < results.part.groups.size(); ++k) {
      if (results.part.groups[k].ground != group.ground) continue;
      if (!std::isnan(point(0, k).second)) points.push_back(point(0, k));
    }
    const double own = interpolate(points, speed);
    if (std::isnan(own)) continue;
    table.add({group.ground, command_text(group.command), fmt::format("{:.2f}", speed),
               fmt::format("{:.3f}", cot), fmt::format("{:.3f}", own),
               fmt::format("{:.2f}", own / cot)});
  }
  return table.text();
}

std::string grid_tables(const PartResults& results, const std::vector<std::string>& policies) {
  const std::vector<Group>& cells = results.part.groups;
  Table table(2);
  table.add({"figure", "policy", "mean of cells", "least", "at", "greatest", "at"});
  const auto at = [&](std::size_t i) {
    return fmt::format("{:.0f}/{:.2f}", cells[i].sigma_flat_npm3 / 1e6,
                       cells[i].sigma_cone_npm3 / 1e6);
  };
  std::string maps;
  for (const char* key :
       {"survival", "velocity_error_mps", "yaw_error_radps", "clearance_iqr_m", "cot", "stride_hz",
        "too_fast_share", "past_stop_share", "tilt_rms_rad", "action_change_rad",
        "velocity_rmse_mps", "body_height_rmse_m", "foot_height_rmse_m"}) {
    const Metric& m = metric(key);
    for (std::size_t p = 0; p < policies.size(); ++p) {
      double sum = 0.0;
      int n = 0;
      std::size_t least = 0, greatest = 0;
      std::vector<double> values;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        values.push_back(pool(m, results.runs[p][i]).value * m.table_scale);
        if (std::isnan(values[i])) continue;
        sum += values[i];
        ++n;
        if (!(values[i] >= values[least])) least = i;
        if (!(values[i] <= values[greatest])) greatest = i;
      }
      const auto number = [&](double v) { return fixed_text(v, m.digits); };
      const std::string heading =
          m.pooling == Pooling::kRate ? fmt::format("{} %", m.heading) : m.heading;
      const std::string name = p == 0 ? heading : "";
      if (n == 0) {
        table.add({name, policies[p], "-", "-", "-", "-", "-"});
        continue;
      }
      table.add({name, policies[p], number(sum / n), number(values[least]), at(least),
                 number(values[greatest]), at(greatest)});
    }
  }
  std::string text = table.text();
  if (policies.size() == 2) {
    double worst = 1.0;
    std::size_t where = 0;
    int below = 0;
    double error[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double lead = pool(metric("survival"), results.runs[0][i]).value -
                          pool(metric("survival"), results.runs[1][i]).value;
      if (lead < worst) {
        worst = lead;
        where = i;
      }
      below += lead < -0.01;
      const auto error_of = [&](std::size_t p) {
        return pool(metric("velocity_error_mps"), results.runs[p][i]).value;
      };
      if (std::isnan(error_of(0)) || std::isnan(error_of(1))) continue;
      for (std::size_t p = 0; p < 2; ++p) error[p] += error_of(p);
    }
    text += fmt::format(
        "  {} against {}: survival more than 1 % lower in {} of {} cells, worst {:+.1f} % at {}; "
        "velocity error {:.2f} times\n",
        policies[0], policies[1], below, cells.size(), 100.0 * worst, at(where),
        error[0] / error[1]);
  }
  return text;
}

/// Commands that all robots survived, of all, by plane and ground.
std::string command_table(const PartResults& results, const std::vector<std::string>& policies) {
  std::string text = fmt::format("Commands survived by all of {} robots, of {}\n",
                                 results.runs.at(0).at(0).size(), kCommandColumns * kCommandRows);
  Table table(3);
  table.add({"plane", "ground", "policy", "survived"});
  constexpr std::size_t kCells = kCommandColumns * kCommandRows;
  for (std::size_t first = 0; first < results.part.groups.size(); first += kCells) {
    const Group& group = results.part.groups[first];
    for (std::size_t p = 0; p < policies.size(); ++p) {
      int survived = 0;
      for (std::size_t i = first; i < first + kCells; ++i) {
        survived += pool(metric("survival"), results.runs[p][i]).value >= 1.0 ? 1 : 0;
      }
      table.add({group.scenario, group.ground, policies[p], fmt::format("{}", survived)});
    }
  }
  return text + table.text();
}

}  // namespace

std::string tables(const PartResults& results, const std::vector<std::string>& policies) {
  if (results.part.name == "straight") {
    std::string text = "Straight run: 1 m, then a track of 5 m\n";
    text += group_table(results, policies,
                        {"track_success", "track_strict_success", "survival", "track_speed_mps",
                         "track_end_speed_mps", "vx_mps", "track_cot", "cot", "clearance_iqr_m",
                         "drift_vy_mps", "drift_yaw_radps"},
                        false);
    text += "\nStraight run: gait, limits, estimate\n";
    text += group_table(
        results, policies,
        {"power_w", "torque_squared_nm2", "stride_hz", "duty", "body_height_m", "tilt_rms_rad",
         "action_change_rad", "too_fast_share", "past_stop_share", "torque_limit_share",
         "joint_speed_max_radps", "velocity_rmse_mps", "body_height_rmse_m", "foot_height_rmse_m"},
        false, false);
    if (policies.size() == 2) {
      text += fmt::format("\nCost of transport at the speeds of {}\n", policies[1]);
      text += cot_at_same_speed(results, policies);
    }
    return text;
  }
  if (results.part.name == "grid") {
    return fmt::format("Stiffness grid: sigma_flat/sigma_cone in MN/m3, {} cells of {} robots\n",
                       results.part.groups.size(), results.runs.at(0).at(0).size()) +
           grid_tables(results, policies);
  }
  if (results.part.name == "turn") {
    return "Turning, sideways, backwards, standing\n" +
           group_table(results, policies,
                       {"survival", "vx_mps", "vy_mps", "yaw_rate_radps", "horizontal_speed_mps",
                        "turning_cot", "cot", "stride_hz", "past_stop_share"},
                       true);
  }
  if (results.part.name == "commands") return command_table(results, policies);
  if (results.part.name == "beyond") {
    return "Slopes, layers, mud\n" +
           group_table(results, policies,
                       {"survival", "vx_mps", "velocity_error_mps", "cot", "body_height_m",
                        "drift_vy_mps", "drift_yaw_radps", "stride_hz"},
                       true);
  }
  return "Robustness\n" +
         group_table(results, policies,
                     {"survival", "disturbance_met", "vx_mps", "velocity_error_mps", "cot",
                      "drift_vy_mps", "drift_yaw_radps", "tilt_rms_rad"},
                     true);
}

}  // namespace sandrunner::evaluate
