// SPDX-License-Identifier: BSD-3-Clause
// E4: the hidden state on four grounds, as a picture and as numbers.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/study/analysis/neighbours.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

constexpr const char* kGrounds[] = {"vinyl", "athletic-track", "grass", "dry-sand"};
constexpr std::size_t kRuns = 8, kStatesOfAGround = 500;
constexpr std::size_t kSteadyFrom = 2 * kPolicyHz;
constexpr int kNeighbours = 10;

// Phase of the left front foot at each sample, linear between its lift-offs; nan before the first
// and after the last. A lift-off is two samples in the air after one on the ground.
std::vector<double> gait_phase(const Ran& run) {
  std::vector<double> phase(run.samples.size(), evaluate::kNotDefined);
  const auto stance = [&](std::size_t i) { return run.samples[i].stance[0]; };
  std::size_t last = 0;
  for (std::size_t i = 1; i + 1 < run.samples.size(); ++i) {
    if (!stance(i - 1) || stance(i) || stance(i + 1)) continue;
    for (std::size_t k = last; last > 0 && k < i; ++k) {
      phase[k] = static_cast<double>(k - last) / static_cast<double>(i - last);
    }
    last = i;
  }
  return phase;
}

struct Collected {
  std::vector<const HiddenState*> hidden;
  std::vector<const Estimate*> estimate;
  States states;  // without points
};

// Equally spaced states of the runs on one ground.
void collect(const std::vector<Ran>& runs, int ground, Collected& all) {
  struct Place {
    std::size_t run, sample;
    double phase;
  };
  std::vector<Place> places;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<double> phase = gait_phase(runs[r]);
    for (std::size_t i = kSteadyFrom; i < phase.size(); ++i) {
      if (!std::isnan(phase[i])) places.push_back({r, i, phase[i]});
    }
  }
  const auto first_run = static_cast<int>(all.states.ground.size());
  all.states.ground.insert(all.states.ground.end(), runs.size(), ground);
  const std::size_t count = std::min(kStatesOfAGround, places.size());
  for (std::size_t k = 0; k < count; ++k) {
    const Place& place = places[k * places.size() / count];
    all.hidden.push_back(&runs[place.run].hidden[place.sample]);
    all.estimate.push_back(&runs[place.run].estimate[place.sample]);
    all.states.run.push_back(first_run + static_cast<int>(place.run));
    all.states.phase.push_back(place.phase);
  }
}

template <typename Rows>
Points as_points(const Rows& rows) {
  Points points(static_cast<Eigen::Index>(rows.size()),
                static_cast<Eigen::Index>(rows.front()->size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < rows[i]->size(); ++k) {
      points(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = (*rows[i])[k];
    }
  }
  return points;
}

// Each column with a deviation of 1: the estimate's parts have different units.
Points standardised(Points points) {
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double mean = points.col(k).mean();
    const double deviation = std::sqrt((points.col(k) - mean).square().mean());
    if (deviation > 0.0) points.col(k) /= deviation;
  }
  return points;
}

}  // namespace

Measured run_hidden_state(Lab& lab, const Model& model) {
  std::vector<std::vector<Ran>> runs;
  Collected all;
  for (const char* ground : kGrounds) {
    evaluate::Trial trial = lab.trial(sim::terrain_preset(ground), {1.0, 0.0, 0.0});
    trial.duration_s = 10.0;
    std::vector<evaluate::Trial> trials = lab.repeat(trial);
    trials.resize(std::min(trials.size(), kRuns));
    runs.push_back(lab.run(model, trials, true));
  }
  for (std::size_t g = 0; g < runs.size(); ++g) collect(runs[g], static_cast<int>(g), all);
  RunGroup group{"four", "", 1.0, {}, {}};
  group.lists["states"] = {static_cast<double>(all.hidden.size())};
  // A robot that falls on all grounds, or that never lifts the foot, leaves nothing to look at.
  if (all.hidden.size() < 10 * kNeighbours) return {{group}};

  all.states.points = as_points(all.hidden);
  const auto neighbours = neighbours_in_other_runs(all.states, kNeighbours);
  group.lists["told"] = {share_told(all.states, neighbours, all.states.ground)};
  group.lists["told_shuffled"] = {shuffled_share_told(all.states, neighbours)};
  group.lists["phase_told"] = {phase_told(all.states, neighbours)};
  const Points embedded = tsne(all.states.points, {});
  for (Eigen::Index i = 0; i < embedded.rows(); ++i) {
    group.lists["x"].push_back(embedded(i, 0));
    group.lists["y"].push_back(embedded(i, 1));
    const auto k = static_cast<std::size_t>(i);
    group.lists["ground"].push_back(all.states.ground[all.states.run[k]]);
    group.lists["phase"].push_back(all.states.phase[k]);
  }
  all.states.points = standardised(as_points(all.estimate));
  const auto of_estimate = neighbours_in_other_runs(all.states, kNeighbours);
  group.lists["told_by_estimate"] = {share_told(all.states, of_estimate, all.states.ground)};
  return {{group}};
}

}  // namespace sandrunner::study
