// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rt/base/worker_pool.h"
#include "tools/train/data/checkpoint.h"
#include "tools/train/data/ranks.h"
#include "tools/train/data/rollout.h"
#include "tools/train/data/symmetry.h"
#include "tools/train/learner/adam.h"
#include "tools/train/learner/block_pass.h"
#include "tools/train/learner/matrix.h"
#include "tools/train/learner/parameters.h"
#include "tools/train/learner/weights.h"

namespace sandrunner::learner {

/// Defaults: for tests; a training's settings are all in training.toml.
struct LearnerConfig {
  NetworkSizes network;
  LossConfig loss;
  /// Environments that are stepped, and differentiated through time, together: the unit of work of
  /// a thread and of a minibatch. Each should hold the same mixture of terrains. Does not depend on
  /// the number of threads, so neither do the weights.
  int block_envs = 64;
  int minibatches = 4;  ///< each of whole blocks, drawn anew in every epoch
  int epochs = 3;
  double gamma = 0.99;
  double lambda = 0.95;
  double max_gradient_norm = 1.0;
  double kl_target = 0.02;  ///< of a minibatch, from the policy that acted
  int average_updates =
      200;  ///< over about this many updates the weights of averaged() are averaged
  double learning_rate_start = 5e-4;
  double learning_rate_min = 2e-5;
  double learning_rate_max = 2e-3;
  double action_std_start = 0.6;
  double action_std_min = 0.2;
  /// Over about this many steps the answers are compared with those of the mirror: what they differ
  /// by for a shorter time, such as a first step, is not pulled together.
  int symmetry_steps = 1;
};

/// Learning rate after a minibatch with divergence `kl`: x 1.2 below half of the target, / 1.3
/// above twice it.
double adapted_learning_rate(double learning_rate, double kl, const LearnerConfig& config);

/// Means over all minibatches of an update, unless said.
struct UpdateStats {
  bool finite = true;  ///< false: a loss or gradient was not finite and nothing was learned
  std::array<double, kEstimateSize> estimate_rms{};  ///< error, units of estimate_target
  double kl = 0.0;
  double explained_variance = 0.0;  ///< 1 - var(target - value) / var(target), before the update
  double learning_rate = 0.0;       ///< after the update
  double action_std = 0.0;          ///< geometric mean, after the update
  /// Rms of mean less symmetric mean, in deviations of the action; nan if nothing pulls them
  /// together.
  double asymmetry = 0.0;
  double imitation_rms = 0.0;  ///< of mean less the teacher's, in network units
  double encoding_rms = 0.0;   ///< of encoding less the teacher's
};

/// Recurrent PPO with a supervised estimator. A window of training:
///
///   (before the first window: write rollout().observation(0), privileged(0), estimate_target(0))
///   pool.run(learner.blocks(), [&](int block, int worker) {
///     for (int t = 0; t < steps; ++t) {
///       learner.act_block(block, t, worker);      // -> rollout().action(t)
///       ... step environments [block * block_envs, (block + 1) * block_envs); write reward(t,
///       env), end(t, env);
///       ... where an episode timed out: write final_privileged(t)
///       ... write observation(t + 1), privileged(t + 1), estimate_target(t + 1), reset(t + 1, env)
///     }
///   });
///   const UpdateStats stats = learner.update();   // also carries step `steps` over to step 0
///
/// Same seed, config and data: same weights, bit for bit, for any number of threads and ranks.
class Learner {
 public:
  /// `pool` must outlive the learner. Throws InputError for sizes and constants that cannot work.
  /// With a symmetry, loss.symmetry_weight pulls the policy's answers to what it sees and to the
  /// mirror image of that together (Yu, Turk, Liu 2018).
  Learner(const LearnerConfig& config, const RolloutShape& shape, std::uint64_t seed,
          WorkerPool& pool, std::optional<Symmetry> symmetry = std::nullopt,
          const Kernels<float>& kernels = best_kernels<float>());

  /// Before the first window: the ranks share the blocks. Each has to call act_block for those of
  /// own_blocks(), for all steps, before update(), which gets the others.
  void share_with(const Ranks& ranks) { ranks_ = ranks; }
  Share own_blocks() const { return ranks_.share(blocks()); }

  Rollout& rollout() { return rollout_; }
  const LearnerConfig& config() const { return config_; }
  int blocks() const { return rollout_.shape.envs / config_.block_envs; }

  /// Answers observation(t), privileged(t) of a block's environments: fills action, mean, log_prob,
  /// value of step t. Different blocks may be run at the same time by different workers.
  void act_block(int block, int t, int worker);

  /// Learns from the whole window and moves on to the next. Not from within a task of the pool.
  /// When not finite, the parameters and the optimiser are as before, but the data that caused it
  /// may live on in the memories.
  UpdateStats update();

  /// Writes and reads everything that the next window depends on, except the environments; of what
  /// is of environments (Checkpoint::put_envs), only that of own_blocks(). Only between update()
  /// and the next act_block. `load` throws InputError if the checkpoint belongs to
  /// other sizes.
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

  std::uint64_t updates() const { return counters_.updates; }
  std::uint64_t transitions() const {
    return counters_.steps * static_cast<std::uint64_t>(rollout_.shape.envs);
  }
  const ParameterLayout& layout() const { return layout_; }
  const std::vector<float>& parameters() const { return parameters_; }
  /// Running mean of the parameters over the last updates: a policy that does not swing with the
  /// latest minibatches (Polyak, Juditsky 1992).
  const std::vector<float>& averaged() const { return averaged_; }

  /// After a return to a checkpoint: makes the next updates differ from those that failed.
  void halve_learning_rate();
  /// KL target of the updates to come.
  void set_kl_target(double kl_target) { config_.kl_target = kl_target; }
  /// Takes the weights of a policy that can act already, before the first step; its actions get
  /// half as much noise again as `action_std_min`.
  void set_policy(const NetworkParameters& policy) {
    from_policy(policy, layout_, parameters_);
    std::fill_n(parameters_.begin() + layout_.log_std(), kActionSize,
                static_cast<float>(std::log(1.5 * config_.action_std_min)));
    averaged_ = parameters_;
    begin_window();
  }
  /// Before the first step: the policy imitates these networks in the states that it visits itself
  /// (Ross, Gordon, Bagnell 2011), and begins with their actor. Only with RolloutShape::teacher.
  /// Throws InputError if encoding or actor are of other sizes.
  void set_teacher(const ParameterLayout& layout, const std::vector<float>& parameters,
                   const Kernels<float>& kernels = best_kernels<float>());
  /// The most noise that actions have from the next update on, even if that is less than
  /// `action_std_min`.
  void set_action_std_most(double action_std) { action_std_most_ = action_std; }
  /// Weight of the pull towards symmetry from now on; without effect if there was none at first.
  void set_symmetry_weight(double weight) {
    if (has_mirror_) config_.loss.symmetry_weight = weight;
  }

 private:
  struct Counters {
    std::uint64_t seed = 0;
    std::uint64_t updates = 0;
    std::uint64_t steps = 0;  // of each environment
    std::uint64_t adam_steps = 0;
    double learning_rate = 0.0;
  };

  // Networks that act in the rollout and do not learn.
  struct Teacher {
    Weights<float> weights;
    std::vector<BlockPass<float>> passes;  // one a worker, one step
    Matrix<float> memory;
    std::uint64_t hash = 0;  // of its parameters
  };

  std::string architecture() const;
  template <typename Self, typename Visit>
  static void visit_arrays(Self& self, const Visit& visit);
  void ask_teacher(int block, int t, int worker);
  void act_in_mirror(int block, int t, int worker);
  void value_timeouts(int first_env, int worker);
  void share_rollout();
  void compute_advantages(UpdateStats& stats);
  std::vector<int> shuffled_blocks(int epoch) const;
  bool learn_minibatch(const int* blocks, int count, UpdateStats& stats);
  double reduce_gradients(int count);
  void begin_window();

  LearnerConfig config_;
  ParameterLayout layout_;
  WorkerPool& pool_;
  Ranks ranks_;
  std::optional<Symmetry> symmetry_;
  bool has_mirror_;  // the policy is also asked what it answers in the mirror
  Rollout rollout_;
  Counters counters_;
  std::vector<float> parameters_;
  Weights<float> weights_;  // the parameters, packed
  std::vector<float> averaged_;
  double action_std_most_ = 1e3;
  Adam adam_;
  Matrix<float> memory_;         // of each environment
  Matrix<float> mirror_memory_;  // of the policy that sees the mirror
  Matrix<float> asymmetry_;      // of each environment's answers, lately
  std::optional<Teacher> teacher_;
  AdvantageScale advantage_scale_;
  std::vector<BlockPass<float>> acting_;       // one a worker, one step
  std::vector<BlockPass<float>> learning_;     // one a worker, a window
  std::vector<std::vector<float>> gradients_;  // one a block of a minibatch
};

}  // namespace sandrunner::learner
