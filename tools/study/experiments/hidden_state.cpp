// SPDX-License-Identifier: BSD-3-Clause
// E4: hidden states on four grounds. A group with the list "states", their number, and if there are
// enough of them: "run" and "phase" of each, "ground_of_run", and packed "hidden" and "estimate".
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rt/telemetry/view/view_pack.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

constexpr const char* kGrounds[] = {"vinyl", "athletic-track", "grass", "dry-sand"};
constexpr std::size_t kRuns = 8, kStatesOfAGround = 500;
constexpr std::size_t kSteadyFrom = 2 * kPolicyHz;
// Fewer say nothing: a robot that falls on all grounds, or never lifts the foot, leaves few.
constexpr std::size_t kFewestStates = 100;

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
  std::vector<double> run, phase, ground_of_run;
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
  const std::size_t first_run = all.ground_of_run.size();
  all.ground_of_run.insert(all.ground_of_run.end(), runs.size(), ground);
  const std::size_t count = std::min(kStatesOfAGround, places.size());
  for (std::size_t k = 0; k < count; ++k) {
    const Place& place = places[k * places.size() / count];
    all.hidden.push_back(&runs[place.run].hidden[place.sample]);
    all.estimate.push_back(&runs[place.run].estimate[place.sample]);
    all.run.push_back(static_cast<double>(first_run + place.run));
    all.phase.push_back(place.phase);
  }
}

template <typename Row>
std::string packed(const std::vector<const Row*>& rows) {
  std::string bytes;
  for (const Row* row : rows) {
    bytes.append(reinterpret_cast<const char*>(row->data()), row->size() * sizeof(float));
  }
  std::string text;
  append_base64(text, bytes);
  return text;
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
  if (all.hidden.size() < kFewestStates) return {{group}};
  group.lists["run"] = all.run;
  group.lists["phase"] = all.phase;
  group.lists["ground_of_run"] = all.ground_of_run;
  group.packed["hidden"] = packed(all.hidden);
  group.packed["estimate"] = packed(all.estimate);
  return {{group}};
}

}  // namespace sandrunner::study
