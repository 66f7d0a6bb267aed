// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tools/train/battery.h"
#include "tools/train/data/checkpoint.h"
#include "tools/train/task/window_stats.h"

namespace sandrunner::train {

/// One row of the learning curve: a window and the update from it.
struct ProgressRow {
  double iteration = 0, transitions = 0, core_hours = 0;  ///< at its end
  double transitions_per_s = 0;
  double simulation_share = 0;  ///< of the wall time of the window, 0 to 1
  WindowStats window;
  double estimate_vx_rms_mps = 0, estimate_height_rms_m = 0;
  double command_speed_mps = 0, ground_open = 0;  ///< the curricula
  BatteryFigures battery;                         ///< the latest
  double score = 0;
  double battery_share = 0;      ///< of the process's core time, 0 to 1
  double late = 0, settled = 0;  ///< share of the late penalties, of the settling
  double learning_rate = 0, kl = 0, action_std = 0, asymmetry = 0, explained_variance = 0;
  double imitation_rms = 0, encoding_rms = 0;
};

/// The learning curve as a trivially copyable list: part of the checkpoint, so that curve and CSV
/// survive a resume.
class Progress {
 public:
  void add(const ProgressRow& row) { rows_.push_back(row); }
  /// The largest share that survived a battery.
  double most_alive() const;
  void save(learner::Checkpoint& checkpoint) const;
  void load(const learner::Checkpoint& checkpoint);

  /// One line for a person, of at most 100 characters; `eta_s`: seconds left.
  static std::string line(const ProgressRow& row, double eta_s);
  /// The battery's figures for a person, in one line.
  static std::string summary(const BatteryFigures& figures);
  /// What its parts mean, for `--explain`.
  static const char* explanation();
  /// Writes curve.csv into `dir`. Throws InputError.
  void write(const std::string& dir) const;
  /// All columns of curve.csv for a page (run_page); of long trainings means of rows, so that
  /// there are at most 1000.
  std::string page_json(const std::string& title) const;

 private:
  std::vector<ProgressRow> rows_;
};

}  // namespace sandrunner::train
