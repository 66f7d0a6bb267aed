// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/train_config.h"

#include <fmt/format.h>

#include <cmath>

#include "rt/base/errors.h"
#include "sim/batch/batch.h"
#include "tools/train/task/settings.h"

namespace sandrunner::train {
namespace {

using R = RunSettings;
constexpr Setting<R> kRun[] = {
    {"envs", &R::envs, 1, 1 << 20},
    {"transitions", &R::transitions, 1.0, 1e13},
    {"checkpoint_interval_s", &R::checkpoint_interval_s, 0.0, 1e6},
    {"settle_share", &R::settle_share, 0.0, 1.0},
    {"settle_kl_share", &R::settle_kl_share, 1e-3, 1.0},
    {"settle_action_std", &R::settle_action_std, 1e-3, 10.0},
    {"settle_soft_reset_share", &R::settle_soft_reset_share, 0.0, 1.0},
};

using B = BatterySettings;
constexpr Setting<B> kBattery[] = {
    {"every_updates", &B::every_updates, 0, 1 << 20},
    {"runs", &B::runs, 1, 1000},
    {"duration_s", &B::duration_s, 1.0, 60.0},
    {"softest_flat_npm3", &B::softest_flat_npm3, 1.0, 1e10},
    {"softest_cone_npm3", &B::softest_cone_npm3, 1.0, 1e10},
    {"softest_spring_npm", &B::softest_spring_npm, 1.0, 1e6},
    {"tracked_error", &B::tracked_error, 0.0, 100.0},
    {"too_fast_weight", &B::too_fast_weight, 0.0, 1e3},
    {"drift_weight", &B::drift_weight, 0.0, 1e3},
};

using G = GateSettings;
constexpr Setting<G> kGate[] = {
    {"enabled", &G::enabled, ""},
    {"least_alive", &G::least_alive, 0.0, 1.0},
    {"rise_transitions", &G::rise_transitions, 1.0, 1e13},
    {"back_rate", &G::back_rate, 0.0, 100.0},
};

using L = learner::LearnerConfig;
constexpr Setting<L> kLearner[] = {
    {"block_envs", &L::block_envs, 1, 1 << 16},
    {"minibatches", &L::minibatches, 1, 1024},
    {"epochs", &L::epochs, 1, 100},
    {"symmetry_steps", &L::symmetry_steps, 1, 10000},
    {"average_updates", &L::average_updates, 1, 1 << 20},
    {"gamma", &L::gamma, 0.0, 0.999999},
    {"lambda", &L::lambda, 0.0, 1.0},
    {"kl_target", &L::kl_target, 1e-6, 10.0},
    {"learning_rate_start", &L::learning_rate_start, 1e-9, 1.0},
    {"learning_rate_min", &L::learning_rate_min, 1e-9, 1.0},
    {"learning_rate_max", &L::learning_rate_max, 1e-9, 1.0},
    {"max_gradient_norm", &L::max_gradient_norm, 1e-6, 1e6},
    {"action_std_start", &L::action_std_start, 1e-3, 10.0},
    {"action_std_min", &L::action_std_min, 1e-3, 10.0},
};

constexpr Setting<learner::LossConfig> kLoss[] = {
    {"estimate_weight", &learner::LossConfig::estimate_weight, 0.0, 1e3},
    {"symmetry_weight", &learner::LossConfig::symmetry_weight, 0.0, 1e3},
};

constexpr Setting<TrainConfig> kWindow[] = {{"window", &TrainConfig::window, 1, 4096}};

std::vector<int> read_widths(ConfigTree& config, const std::string& key) {
  require_key(config, key);
  std::vector<int> widths;
  for (const double width : config.numbers(key, {}, ConfigTree::kAnySize, 1.0, 4096.0)) {
    if (width != std::floor(width)) {
      throw InputError(fmt::format("{}: {}, expected whole numbers", key, width));
    }
    widths.push_back(static_cast<int>(width));
  }
  return widths;
}

learner::LearnerConfig read_learner_config(ConfigTree& config) {
  learner::LearnerConfig l;
  read_required(config, "learner", kLearner, l);
  l.network.critic = read_widths(config, "learner.critic");
  read_required(config, "learner", kLoss, l.loss);
  return l;
}

void read_battery(ConfigTree& config, BatterySettings& battery) {
  read_required(config, "battery", kBattery, battery);
  read_array(config, "battery.forward_share", 0.01, 1.0, battery.forward_share);
}

void read_gate(ConfigTree& config, const BatterySettings& battery, GateSettings& gate) {
  read_required(config, "gate", kGate, gate);
  if (gate.enabled && battery.every_updates == 0) {
    throw InputError(
        "training config: battery.every_updates = 0, expected at least 1, or gate.enabled = false");
  }
}

void read_wiring(ConfigTree& config, TrainConfig& c) {
  const auto text = [&](const std::string& key) {
    require_key(config, key);
    return config.text(key, "");
  };
  learner::NetworkSizes& network = c.learner.network;
  network.wiring.encoder = parse_encoder("network.encoder", text("network.encoder"));
  network.wiring.actor_sees = parse_actor_inputs("network.actor", text("network.actor"));
  c.teacher = text("imitation.teacher");
  if (c.teacher.empty()) return;
  c.learner.loss.policy_weight = 0.0;
  c.learner.loss.imitation_weight = c.learner.loss.encoding_weight = 1.0;
}

// What one table asks of another.
void check_blocks(const TrainConfig& c) {
  const int block_envs = c.learner.block_envs;
  if (block_envs % static_cast<int>(sim::BatchWidth::kSixteen) != 0) {
    throw InputError(fmt::format(
        "training config: learner.block_envs = {}, expected a multiple of 16, the robots of a pack",
        block_envs));
  }
  if (c.run.envs % block_envs != 0) {
    throw InputError(fmt::format(
        "training config: run.envs = {}, expected a multiple of learner.block_envs = {}",
        c.run.envs, block_envs));
  }
  const int special = c.task.ground.rigid_envs + c.task.ground.patchy_envs;
  if (special > block_envs) {
    throw InputError(fmt::format(
        "training config: ground.rigid_envs + ground.patchy_envs = {}, expected at most "
        "learner.block_envs = {}",
        special, block_envs));
  }
}

}  // namespace

TrainConfig read_train_config(ConfigTree& config) {
  TrainConfig c;
  read_required(config, "run", kRun, c.run);
  read_battery(config, c.battery);
  read_gate(config, c.battery, c.gate);
  read_required(config, "learner", kWindow, c);
  c.learner = read_learner_config(config);
  c.task = read_task_config(config);
  read_wiring(config, c);
  check_blocks(c);
  config.reject_unknown();
  c.effective = config.effective();
  return c;
}

}  // namespace sandrunner::train
