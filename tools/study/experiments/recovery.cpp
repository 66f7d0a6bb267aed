// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/recovery.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rt/base/quantile.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

constexpr std::size_t kSecond = kPolicyHz;
constexpr std::size_t kMean = 3 * kPolicyHz / 10, kStays = kPolicyHz / 2;
constexpr double kBack = 0.9;
constexpr int kLeftFront = 0, kRightFront = 1;

struct Swing {
  std::size_t end;  ///< the first sample of the next stance
  double height_m;  ///< greatest
};

std::vector<Swing> swings_of(const Ran& run, int leg) {
  std::vector<Swing> swings;
  double height = 0.0;
  bool in_air = false;
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    const Sample& s = run.samples[i];
    if (!s.stance[leg]) height = std::max(in_air ? height : 0.0, double{s.foot_height_m[leg]});
    if (s.stance[leg] && in_air) swings.push_back({i, height});
    in_air = !s.stance[leg];
  }
  return swings;
}

double mean_vx(const Ran& run, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) sum += run.samples[i].vx_mps;
  return sum / static_cast<double>(end - begin);
}

double time_until_back(const Ran& run, std::size_t at, double before_mps) {
  std::size_t good = 0;  // samples since which the speed has been back
  for (std::size_t i = at; i + kMean <= run.samples.size(); ++i) {
    good = mean_vx(run, i, i + kMean) >= kBack * before_mps ? good + 1 : 0;
    if (good > kStays) return static_cast<double>(i - kStays - at) * kStep_s;
  }
  return evaluate::kNotDefined;
}

double swing_ratio(const Ran& run, std::size_t at) {
  std::vector<double> usual;
  for (const Swing& swing : swings_of(run, kRightFront)) {
    if (swing.end + kSecond > at && swing.end <= at) usual.push_back(swing.height_m);
    if (swing.end <= at) continue;
    std::sort(usual.begin(), usual.end());
    return usual.empty() ? evaluate::kNotDefined : swing.height_m / quantile(usual, 0.5);
  }
  return evaluate::kNotDefined;
}

// Dry sand of which one foot will find a looser part, out of reach otherwise.
sim::TerrainDescription sand_with_loose_patch(double factor) {
  sim::TerrainDescription ground = sim::terrain_preset("dry-sand");
  sim::GroundParameters loose = ground.patches[0].ground;
  loose.sigma_flat_npm3 *= factor;
  loose.sigma_cone_npm3 *= factor;
  ground.patches.push_back({1e9, loose});
  return ground;
}

RunGroup loose_stance(Lab& lab, const Model& model, const char* scenario, double factor) {
  constexpr double kCommand_mps = 2.5;
  evaluate::Trial trial = lab.trial(sand_with_loose_patch(factor), {kCommand_mps, 0.0, 0.0});
  trial.duration_s = 10.0;
  // Beyond the stretch in which it speeds up: the second before is what it is compared with.
  trial.loose_step = {5.0, kLeftFront};
  RunGroup group{"dry-sand", scenario, kCommand_mps, {}, {}};
  for (const Ran& run : lab.run(model, lab.repeat(trial))) {
    const Recovery recovery =
        recovery_of(run).value_or(Recovery{evaluate::kNotDefined, evaluate::kNotDefined});
    group.runs["alive"].push_back(!run.figures.fell);
    group.runs["met"].push_back(run.figures.disturbance_met);
    group.runs["recovery_s"].push_back(recovery.time_s);
    group.runs["swing_ratio"].push_back(recovery.swing_ratio);
  }
  return group;
}

RunGroup transition(Lab& lab, const Model& model, double command) {
  constexpr double kWetFrom_m = 8.0;
  sim::TerrainDescription ground = sim::terrain_preset("dry-sand");
  ground.patches.push_back({kWetFrom_m, sim::terrain_preset("wet-sand").patches[0].ground});
  evaluate::Trial trial = lab.trial(ground, {command, 0.0, 0.0});
  trial.duration_s = 6.0;
  trial.track_begin_m = 10.0;
  trial.track_end_m = 14.0;
  trial.ground_changes_at_m = kWetFrom_m;
  RunGroup group{"dry-sand", "transition", command, {}, {}};
  for (const Ran& run : lab.run(model, lab.repeat(trial))) {
    group.runs["alive"].push_back(!run.figures.fell);
    group.runs["speed_before_mps"].push_back(mean_speed(run, 5.0, kWetFrom_m));
    group.runs["speed_after_mps"].push_back(run.figures.track_speed_mps);
  }
  return group;
}

}  // namespace

std::optional<Recovery> recovery_of(const Ran& run) {
  const auto met = std::find_if(run.samples.begin(), run.samples.end(),
                                [](const Sample& s) { return s.on_patch[kLeftFront]; });
  const auto at = static_cast<std::size_t>(met - run.samples.begin());
  if (met == run.samples.end() || at < kSecond) return std::nullopt;
  return Recovery{time_until_back(run, at, mean_vx(run, at - kSecond, at)), swing_ratio(run, at)};
}

Measured run_recovery(Lab& lab, const Model& model) {
  Measured measured;
  measured.groups.push_back(loose_stance(lab, model, "half", 0.5));
  measured.groups.push_back(loose_stance(lab, model, "quarter", 0.25));
  for (const double command : {2.0, 3.0, 4.0}) {
    measured.groups.push_back(transition(lab, model, command));
  }
  return measured;
}

}  // namespace sandrunner::study
