// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/progress.h"

#include <fmt/format.h>

#include "rt/base/output_files.h"
#include "rt/plot/plot.h"

namespace sandrunner::train {
namespace {

using R = const ProgressRow&;

struct Column {
  const char* name;
  double (*value)(R row);
};

// The terms of the reward follow, each as reward_<name>.
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
};

constexpr plot::Color kBlue{0.12, 0.37, 0.64}, kOrange{0.90, 0.45, 0.10};

}  // namespace

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
      "{:6.2f} M {:3.0f} k/s  reward {:.3f} track {:.2f}  falls {:.2f} {:4.1f} Hz  trot {:+.2f}  "
      "std {:.2f} {:.1f} m/s {:3.0f} min",
      r.transitions / 1e6, r.transitions_per_s / 1e3, w.reward, w.kernel[1], w.falls[1],
      w.stride_hz, w.diagonal, r.action_std, r.command_speed_mps, eta_s / 60.0);
}

const char* Progress::explanation() {
  return "A line of progress, of the last update's steps, on soil:\n"
         "  M        transitions so far, millions; a transition is 10 ms of one robot\n"
         "  k/s      transitions a second, thousands\n"
         "  reward   mean of a step\n"
         "  track    how well the commanded velocity is kept, 0 to 1\n"
         "  falls    of a robot in 4 s, under noise, pushes and all commands that are open\n"
         "  Hz       strides a second\n"
         "  trot     correlation of diagonal feet in the air: 1 is a trot, below 0 they take "
         "turns\n"
         "  std      noise of the actions, in units of the network's output\n"
         "  m/s      fastest command that is drawn; opens as the robots follow\n"
         "  min      minutes left\n"
         "curve.csv has a row for each update: all of these, hard ground besides, and each term of "
         "the\nreward by its name (reward_...); curve.png draws the most telling ones.\n";
}

void Progress::write(const std::string& dir) const {
  std::string csv;
  for (const Column& c : kColumns) csv += fmt::format("{}{}", csv.empty() ? "" : ",", c.name);
  for (std::size_t i = 0; i < kRewardTerms; ++i) {
    csv += fmt::format(",reward_{}", reward_term_name(i));
  }
  csv += "\n";
  for (const ProgressRow& row : rows_) {
    bool first = true;
    for (const Column& c : kColumns) {
      csv += fmt::format("{}{:.6g}", first ? "" : ",", c.value(row));
      first = false;
    }
    for (const double term : row.window.terms) csv += fmt::format(",{:.6g}", term);
    csv += "\n";
  }
  write_file(dir + "/curve.csv", csv);
  if (rows_.size() < 2) return;

  plot::Figure figure;
  figure.title = "Training";
  figure.x_label = "transitions, millions";
  for (const ProgressRow& row : rows_) figure.x.push_back(row.transitions / 1e6);
  const auto series = [&](const char* name, plot::Color color, double (*value)(R)) {
    plot::Series s;
    s.name = name;
    s.color = color;
    for (const ProgressRow& row : rows_) s.y.push_back(value(row));
    return s;
  };
  figure.panels.push_back(
      {"Reward", "a step", {series("reward", kBlue, [](R r) { return r.window.reward; })}});
  figure.panels.push_back({"Velocity tracking",
                           "kernel, 0 to 1",
                           {series("rigid", kBlue, [](R r) { return r.window.kernel[0]; }),
                            series("soil", kOrange, [](R r) { return r.window.kernel[1]; })}});
  figure.panels.push_back({"Falls",
                           "per robot and 4 s",
                           {series("rigid", kBlue, [](R r) { return r.window.falls[0]; }),
                            series("soil", kOrange, [](R r) { return r.window.falls[1]; })}});
  figure.panels.push_back(
      {"Gait: strides", "Hz", {series("stride", kBlue, [](R r) { return r.window.stride_hz; })}});
  figure.panels.push_back(
      {"Gait: feet together in the air",
       "correlation",
       {series("diagonal", kBlue, [](R r) { return r.window.diagonal; }),
        series("side by side", kOrange, [](R r) { return r.window.abreast; })}});
  figure.panels.push_back(
      {"Curricula",
       "m/s; 0 to 1",
       {series("commanded speed", kBlue, [](R r) { return r.command_speed_mps; }),
        series("softness of the ground", kOrange, [](R r) { return r.ground_open; })}});
  figure.panels.push_back(
      {"Estimator",
       "rms error",
       {series("vx, m/s", kBlue, [](R r) { return r.estimate_vx_rms_mps; }),
        series("body height, m", kOrange, [](R r) { return r.estimate_height_rms_m; })}});
  figure.views.push_back({"", figure.x.front(), figure.x.back()});
  plot::draw(figure, dir + "/curve.png");
}

}  // namespace sandrunner::train
