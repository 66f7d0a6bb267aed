// SPDX-License-Identifier: BSD-3-Clause
// E8: what the answers of the two oracles depend on. Names of the numbers that it measures, in a
// group of runs on kGround:
//   runs: ablation of the groups of inputs "cmd", "h" or "o", "e" and "T"; a run is a block of 48
//   robots, which has the same starts, grounds and commands for every controller
//   lists: "states", "robots", "fell" (share of the robots), "gap_median", "gap_p99"; in ten bins
//   of sigma_flat "bin_sigma_npm3" (middle), "bin_states", "bin_T" (ablation of T); of each
//   parameter of the ground "deviation", "alone" (its ablation), and the lists of kGradients
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "rt/base/config_tree.h"
#include "rt/base/quantile.h"
#include "tools/study/experiments/attribution.h"
#include "tools/study/experiments/experiments.h"
#include "tools/study/simulated/task_run.h"
#include "tools/train/task/leg_modes.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

using learner::Matrix;

constexpr const char* kGround = "training";
constexpr int kSigmaFlat = 1;  // its place among the parameters of the ground
// Lists with the mean |integrated gradient| of each parameter, by kind of joint.
constexpr const char* kGradients[kJointsPerLeg] = {"gradient_haa", "gradient_hfe", "gradient_kfe"};

constexpr int kBlockEnvs = 48;
// The paper's 10,800 robots; fewer with fewer than the 360 runs of a cell of its grid.
constexpr int kMostBlocks = 225, kPaperGridRuns = 360;
constexpr int kSteps = 4 * kPolicyHz, kEvery = 20;  // a state every 20 steps
constexpr int kStatesOfAnEnv = kSteps / kEvery;
constexpr int kMostStates = 8192;
constexpr int kBins = 10;
constexpr std::uint64_t kSeed = 8;

// The task of the model's own training, on soil alone: hard ground and patches would mix other
// parameters into the mean input. A setting that its trainer did not have yet is the usual one.
train::TaskConfig task_on_soil(const train::TaskNetwork& network, const sim::Robot& robot) {
  ConfigTree settings;
  train::add_training_layers(settings, robot);
  settings.add_text(network.spec.provenance.at("config"), "provenance.config");
  train::TaskConfig task = train::read_task_config(settings);
  task.ground.rigid_envs = task.ground.patchy_envs = 0;
  return task;
}

// Of all states some, evenly.
struct Selection {
  std::int64_t all, kept;
  // The place of a state among those that are kept; -1: it is not.
  std::int64_t place(std::int64_t state) const {
    const std::int64_t next = (state * kept + all - 1) / all;
    return next < kept && next * all / kept == state ? next : -1;
  }
  std::int64_t state(std::int64_t place) const { return place * all / kept; }
};

struct States {
  Selection selection{};
  Matrix<float> inputs;  // of the actor, a state a column
  int blocks = 0;
  double fell = 0.0;  // share of the robots

  int block(std::int64_t place) const {
    return static_cast<int>(selection.state(place) / (kStatesOfAnEnv * kBlockEnvs));
  }
};

States collect(const train::TaskNetwork& network, const train::TaskConfig& task, int grid_runs,
               const sim::Robot& robot, WorkerPool& pool) {
  States states;
  states.blocks = std::clamp(kMostBlocks * grid_runs / kPaperGridRuns, 1, kMostBlocks);
  const int envs = states.blocks * kBlockEnvs;
  const std::int64_t all = std::int64_t{envs} * kStatesOfAnEnv;
  states.selection = {all, std::min<std::int64_t>(all, kMostStates)};
  states.inputs.resize(network.layout.actor_inputs(), states.selection.kept);
  std::vector<std::uint8_t> fell(static_cast<std::size_t>(envs));
  TaskRun run{task, envs, kBlockEnvs, kSteps, kSeed};
  run_on_task(network, run, robot, pool, [&](const TaskStep& step) {
    for (int i = 0; i < step.envs; ++i) {
      const int env = step.first_env + i;
      const bool falls = step.rollout.end(0, env) == learner::End::kTerminated;
      fell[static_cast<std::size_t>(env)] |= static_cast<std::uint8_t>(falls);
      if ((step.step + 1) % kEvery != 0) continue;
      const std::int64_t place =
          states.selection.place(std::int64_t{env} * kStatesOfAnEnv + step.step / kEvery);
      if (place >= 0) states.inputs.col(place) = step.actor_input.col(i);
    }
  });
  states.fell = static_cast<double>(std::count(fell.begin(), fell.end(), 1)) / envs;
  return states;
}

// The actor's inputs by what they are, then each parameter of the ground by itself.
std::vector<InputGroup> input_groups(const learner::ParameterLayout& layout) {
  std::vector<InputGroup> groups;
  int first = 0;
  const auto add = [&](bool seen, const char* name, int count) {
    if (seen) groups.push_back({name, first, count});
    if (seen) first += count;
  };
  const ActorInputs& sees = layout.sizes().wiring.actor_sees;
  add(true, "cmd", kCommandSize);
  add(sees.encoding, "h", layout.hidden());
  add(sees.estimate, "e", kEstimateSize);
  add(sees.proprioception, "o", learner::kProprioceptionSize);
  add(sees.terrain, "T", kTerrainSize);
  for (int i = 0; i < kTerrainSize; ++i) {
    groups.push_back({"", first - kTerrainSize + i, 1});
  }
  return groups;
}

// The actor with answers in joints.
ActorFunction joint_actor(const train::TaskNetwork& network,
                          const std::array<double, kNumLegs>& mode_gain) {
  std::vector<float> parameters = network.parameters;
  const learner::LayerView& last = network.layout.actor().back();
  train::joints_from_modes(mode_gain, network.parameters.data() + last.weight,
                           static_cast<std::size_t>(last.inputs), parameters.data() + last.weight);
  train::joints_from_modes(mode_gain, network.parameters.data() + last.bias, 1,
                           parameters.data() + last.bias);
  return {network.layout.actor(), parameters};
}

// Mean over the states of each block of robots; nan for a block without one.
std::vector<double> mean_of_blocks(const States& states, const Eigen::VectorXd& of_states) {
  std::vector<std::vector<double>> values(static_cast<std::size_t>(states.blocks));
  for (Eigen::Index i = 0; i < of_states.size(); ++i) {
    values[static_cast<std::size_t>(states.block(i))].push_back(of_states[i]);
  }
  std::vector<double> means;
  for (const std::vector<double>& of_block : values) means.push_back(mean_of(of_block));
  return means;
}

// The ablation of T in equal bins of the logarithm of sigma_flat, over all that the training draws.
void add_bins(const States& states, const train::GroundSettings& ground,
              const Eigen::VectorXd& ablation, RunGroup& group) {
  const double low = std::log10(ground.sigma_flat_low / train::kUsualSigmaFlat_npm3);
  const double high = std::log10(ground.sigma_flat_high / train::kUsualSigmaFlat_npm3);
  const Eigen::Index row = states.inputs.rows() - kTerrainSize + kSigmaFlat;
  std::vector<std::vector<double>> values(kBins);
  for (Eigen::Index i = 0; i < ablation.size(); ++i) {
    const double share = (static_cast<double>(states.inputs(row, i)) - low) / (high - low);
    const int bin = std::clamp(static_cast<int>(kBins * share), 0, kBins - 1);
    values[static_cast<std::size_t>(bin)].push_back(ablation[i]);
  }
  for (int bin = 0; bin < kBins; ++bin) {
    const std::vector<double>& of_bin = values[static_cast<std::size_t>(bin)];
    const double middle = low + (bin + 0.5) / kBins * (high - low);
    group.lists["bin_sigma_npm3"].push_back(train::kUsualSigmaFlat_npm3 * std::pow(10.0, middle));
    group.lists["bin_states"].push_back(static_cast<double>(of_bin.size()));
    group.lists["bin_T"].push_back(mean_of(of_bin));
  }
}

// What is measured of each parameter of the ground.
void add_parameters(const Attribution& a, std::size_t first_alone, RunGroup& group) {
  const Eigen::Index first_input = a.reference.size() - kTerrainSize;
  for (int i = 0; i < kTerrainSize; ++i) {
    const Eigen::Index input = first_input + i;
    group.lists["deviation"].push_back(a.deviation[input]);
    group.lists["alone"].push_back(
        a.ablation.row(static_cast<Eigen::Index>(first_alone) + i).mean());
    for (int joint = 0; joint < kJointsPerLeg; ++joint) {
      double sum = 0.0;
      for (int leg = 0; leg < kNumLegs; ++leg) {
        sum += a.gradients(kJointsPerLeg * leg + joint, input);
      }
      group.lists[kGradients[joint]].push_back(sum / kNumLegs);
    }
  }
}

}  // namespace

Measured run_attribution(Lab& lab, const Model& model) {
  WorkerPool pool(lab.settings().threads);
  const train::TaskConfig task = task_on_soil(model.network, lab.robot());
  const States states = collect(model.network, task, lab.settings().grid_runs, lab.robot(), pool);
  const std::vector<InputGroup> groups = input_groups(model.network.layout);
  const Attribution a =
      attribute(joint_actor(model.network, task.policy.mode_gain), states.inputs, groups, pool);

  RunGroup group{kGround, "", 0.0, {}, {}};
  const std::size_t named = groups.size() - kTerrainSize;
  for (std::size_t g = 0; g < named; ++g) {
    group.runs[groups[g].name] =
        mean_of_blocks(states, a.ablation.row(static_cast<Eigen::Index>(g)));
  }
  add_bins(states, task.ground, a.ablation.row(static_cast<Eigen::Index>(named) - 1), group);
  add_parameters(a, named, group);
  std::vector<double> gaps = a.gap;
  std::ranges::sort(gaps);
  group.lists["gap_median"] = {quantile(gaps, 0.5)};
  group.lists["gap_p99"] = {quantile(gaps, 0.99)};
  group.lists["states"] = {static_cast<double>(states.selection.kept)};
  group.lists["robots"] = {static_cast<double>(states.blocks) * kBlockEnvs};
  group.lists["fell"] = {states.fell};
  return {{group}};
}

}  // namespace sandrunner::study
