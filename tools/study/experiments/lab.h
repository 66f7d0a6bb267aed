// SPDX-License-Identifier: BSD-3-Clause
// Where the experiments of the paper's Figs. 2 and 3 are run: on the runner of sandrunner-evaluate,
// 4 kHz, with the training's sensor noise, targets 5 ms late and the drives' torque-speed line.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/evaluate/runner.h"
#include "tools/evaluate/study.h"
#include "tools/study/experiments/models.h"
#include "tools/study/experiments/runs.h"

namespace sandrunner::study {

inline constexpr double kStep_s = 1.0 / kPolicyHz;
inline constexpr int kLatency_ticks = 20;

/// A robot at the start of a policy step.
struct Sample {
  float x_m = 0, vx_mps = 0, yaw_rate_radps = 0;  ///< vx in the heading frame
  std::array<float, kNumLegs> foot_height_m{};    ///< of its centre above the undisturbed ground
  std::array<float, kNumLegs> depth_m{};  ///< the deepest of the stance so far; 0: in the air
  std::array<bool, kNumLegs> stance{};
  std::array<bool, kNumLegs> on_patch{};  ///< stands on a patch of ground beyond the first
  std::array<float, kNumJoints> torque_nm{};
};
using HiddenState = decltype(NetworkState::h);
using Estimate = std::array<float, kEstimateSize>;

/// One run.
struct Ran {
  evaluate::TrialFigures figures;
  std::vector<Sample> samples;
  std::vector<HiddenState> hidden;  ///< of each sample, if asked for
  std::vector<Estimate> estimate;   ///< as `hidden`: height, velocity, feet
};

struct LabSettings {
  int runs = 16;
  int threads = 1;
  int grid_runs = 360;  ///< robots in each cell of E7's grid
  int grid_cells = 10;  ///< of it, each way
};

class Lab {
 public:
  explicit Lab(const LabSettings& settings);

  const LabSettings& settings() const noexcept { return settings_; }
  const sim::Robot& robot() const noexcept { return study_.robot(); }
  /// A trial on this ground under this command, with what all runs of the study share.
  evaluate::Trial trial(const sim::TerrainDescription& ground, const VelocityCommand& command);
  /// `LabSettings::runs` trials like this one, each with its own start and noise.
  std::vector<evaluate::Trial> repeat(const evaluate::Trial& like) const;
  /// Runs them all; the results do not depend on the number of threads.
  std::vector<Ran> run(const Model& model, const std::vector<evaluate::Trial>& trials,
                       bool with_hidden = false) const;

 private:
  LabSettings settings_;
  evaluate::Study study_;
};

/// The eight commands of the paper's straight runs, m/s.
std::vector<double> straight_commands();

/// The deepest point of each stance that ended from sample `begin` on, of the legs from `first_leg`
/// to `last_leg`, m.
std::vector<double> stance_depths(const Ran& run, std::size_t begin, int first_leg, int last_leg);

/// Mean of vx over the samples whose x lies in [from_m, to_m); nan if there are none.
double mean_speed(const Ran& run, double from_m, double to_m);

/// The figures of straight runs that tables, pictures and claims use, by name.
RunGroup straight_group(const std::string& ground, double command, const std::vector<Ran>& runs);

/// Those of turns on the spot.
RunGroup turn_group(const std::string& ground, double command, const std::vector<Ran>& runs);

}  // namespace sandrunner::study
