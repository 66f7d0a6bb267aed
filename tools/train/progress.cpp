// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/progress.h"

#include <fmt/format.h>

#include "rt/base/output_files.h"
#include "rt/plot/plot.h"

namespace sandrunner::train {
namespace {

struct Column {
  const char* name;
  double ProgressRow::*value;
};

constexpr Column kColumns[] = {
    {"iteration", &ProgressRow::iteration},
    {"transitions", &ProgressRow::transitions},
    {"core_hours", &ProgressRow::core_hours},
    {"transitions_per_s", &ProgressRow::transitions_per_s},
    {"simulation_share", &ProgressRow::simulation_share},
    {"reward", &ProgressRow::reward},
    {"kernel_rigid", &ProgressRow::kernel_rigid},
    {"kernel_soil", &ProgressRow::kernel_soil},
    {"falls_rigid_per_4s", &ProgressRow::falls_rigid},
    {"falls_soil_per_4s", &ProgressRow::falls_soil},
    {"speed_ratio_rigid", &ProgressRow::speed_ratio_rigid},
    {"speed_ratio_soil", &ProgressRow::speed_ratio_soil},
    {"estimate_vx_rms_mps", &ProgressRow::estimate_vx_rms_mps},
    {"estimate_height_rms_m", &ProgressRow::estimate_height_rms_m},
    {"command_speed_mps", &ProgressRow::command_speed_mps},
    {"ground_open", &ProgressRow::ground_open},
    {"body_height_m", &ProgressRow::body_height_m},
    {"torque_squared_nm2", &ProgressRow::torque_squared},
    {"power_w", &ProgressRow::power_w},
    {"stride_hz", &ProgressRow::stride_hz},
    {"abreast", &ProgressRow::abreast},
    {"diagonal", &ProgressRow::diagonal},
    {"learning_rate", &ProgressRow::learning_rate},
    {"kl", &ProgressRow::kl},
    {"action_std", &ProgressRow::action_std},
    {"asymmetry", &ProgressRow::asymmetry},
    {"explained_variance", &ProgressRow::explained_variance},
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
  return fmt::format(
      "{:5.0f}  {:6.2f} M  {:5.1f} k/s ({:2.0f} % sim)  reward {:.4f}  track {:.2f}/{:.2f}  falls "
      "{:.2f}/{:.2f}  "
      "v/cmd {:.2f}/{:.2f}  est {:.2f} m/s  vmax {:.2f}  soft {:.2f}  h {:.3f}  {:.1f} Hz  "
      "gait {:+.2f}/{:+.2f}  std "
      "{:.2f}  eta {:.0f} min",
      r.iteration, r.transitions / 1e6, r.transitions_per_s / 1e3, 100.0 * r.simulation_share,
      r.reward, r.kernel_rigid, r.kernel_soil, r.falls_rigid, r.falls_soil, r.speed_ratio_rigid,
      r.speed_ratio_soil, r.estimate_vx_rms_mps, r.command_speed_mps, r.ground_open,
      r.body_height_m, r.stride_hz, r.abreast, r.diagonal, r.action_std, eta_s / 60.0);
}

void Progress::write(const std::string& dir) const {
  std::string csv;
  for (const Column& c : kColumns) csv += fmt::format("{}{}", csv.empty() ? "" : ",", c.name);
  csv += "\n";
  for (const ProgressRow& row : rows_) {
    bool first = true;
    for (const Column& c : kColumns) {
      csv += fmt::format("{}{:.6g}", first ? "" : ",", row.*c.value);
      first = false;
    }
    csv += "\n";
  }
  write_file(dir + "/curve.csv", csv);
  if (rows_.size() < 2) return;

  plot::Figure figure;
  figure.title = "Training";
  figure.x_label = "transitions, millions";
  for (const ProgressRow& row : rows_) figure.x.push_back(row.transitions / 1e6);
  const auto series = [&](const char* name, plot::Color color, double ProgressRow::*value) {
    plot::Series s;
    s.name = name;
    s.color = color;
    for (const ProgressRow& row : rows_) s.y.push_back(row.*value);
    return s;
  };
  figure.panels.push_back({"Reward", "a step", {series("reward", kBlue, &ProgressRow::reward)}});
  figure.panels.push_back({"Velocity tracking",
                           "kernel, 0 to 1",
                           {series("rigid", kBlue, &ProgressRow::kernel_rigid),
                            series("soil", kOrange, &ProgressRow::kernel_soil)}});
  figure.panels.push_back({"Falls",
                           "per robot and 4 s",
                           {series("rigid", kBlue, &ProgressRow::falls_rigid),
                            series("soil", kOrange, &ProgressRow::falls_soil)}});
  figure.panels.push_back({"Curricula",
                           "m/s; 0 to 1",
                           {series("commanded speed", kBlue, &ProgressRow::command_speed_mps),
                            series("softness of the ground", kOrange, &ProgressRow::ground_open)}});
  figure.panels.push_back(
      {"Estimator",
       "rms error",
       {series("vx, m/s", kBlue, &ProgressRow::estimate_vx_rms_mps),
        series("body height, m", kOrange, &ProgressRow::estimate_height_rms_m)}});
  figure.views.push_back({"", figure.x.front(), figure.x.back()});
  plot::draw(figure, dir + "/curve.png");
}

}  // namespace sandrunner::train
