// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "rt/base/build.h"
#include "rt/base/clock_ns.h"
#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/processor_name.h"
#include "rt/base/standard_error.h"
#include "tools/train/curve_page.h"

namespace sandrunner::train {
namespace {

using Names = std::array<char, 1024>;

constexpr int kMostFallbacks = 5;

/// A policy that does so in its battery walks; whatever the thresholds of the gate are.
constexpr double kWalksAlive = 0.8, kWalksError = 0.2;

double cpu_seconds() { return clock_s(CLOCK_PROCESS_CPUTIME_ID); }
double wall_seconds() { return clock_s(CLOCK_MONOTONIC); }

// Of the figures by which a robot moves: another one would not continue to the same weights.
std::uint64_t hash_of(const sim::Robot& robot) {
  const auto bytes = [](const auto& figures) {  // doubles without padding
    return std::string_view(reinterpret_cast<const char*>(&figures), sizeof(figures));
  };
  std::uint64_t hash = learner::fnv1a(robot.description.name);
  hash = learner::fnv1a(bytes(robot.model), hash);
  hash = learner::fnv1a(bytes(robot.nominal_rad), hash);
  hash = learner::fnv1a(bytes(robot.torque_speed_line), hash);
  hash = learner::fnv1a(bytes(robot.motor_constant_nmpsqrtw), hash);
  return learner::fnv1a(bytes(robot.nominal_height_m), hash);
}

// Adds a name to a list with commas, unless it is there.
void add_name(std::string& list, std::string_view name) {
  if (fmt::format(", {}, ", list).find(fmt::format(", {}, ", name)) != std::string::npos) return;
  list += list.empty() ? "" : ", ";
  list += name;
}

// Those of all ranks.
std::string all_of(const learner::Ranks& ranks, const std::string& name) {
  std::vector<Names> names(static_cast<std::size_t>(ranks.size()));
  const learner::Share own = ranks.share(ranks.size());
  name.copy(names[static_cast<std::size_t>(own.begin)].data(), Names().size() - 1);
  ranks.gather(std::span(names), ranks.size());
  std::string list;
  for (const Names& one : names) add_name(list, one.data());
  return list;
}

learner::RolloutShape rollout_shape(const TrainConfig& config) {
  learner::RolloutShape shape;
  shape.envs = config.run.envs;
  shape.steps = config.window;
  shape.privileged = Task::privileged_size();
  const bool imitates = !config.teacher.empty();
  shape.insight = imitates || config.learner.network.wiring.sees_insight() ? kInsightSize : 0;
  shape.teacher = imitates ? config.learner.network.hidden : 0;
  return shape;
}

}  // namespace

Training::Training(const TrainConfig& config, const sim::Robot& robot,
                   const TrainingOptions& options)
    : config_(config),
      robot_(robot),
      options_(options),
      pool_(options.threads),
      task_(config.task, robot, {config.run.envs, config.learner.block_envs}, options.seed),
      learner_(config.learner, rollout_shape(config), options.seed, pool_, Task::symmetry(robot)),
      gate_(config.gate, config.battery.tracked_error, config.run.transitions,
            config.run.settle_share, config.task.reward.prior_start_transitions),
      checkpoint_path_(checkpoint_path(options.out)),
      config_hash_(learner::fnv1a(config.effective, learner::kHashStart ^ options.seed)),
      robot_hash_(hash_of(robot)),
      builds_(all_of(ranks_, build_commit())),
      processors_(all_of(ranks_, processor_name())) {
  learner_.share_with(ranks_);
  if (!config.teacher.empty()) imitate(config.teacher);
  if (config.battery.every_updates > 0) {
    battery_.emplace(config.battery, config.task, config.learner.block_envs, robot,
                     learner_.layout(), pool_);
  }
}

void Training::start() {
  pool_.run(learner_.blocks(),
            [&](int block, int) { task_.observe(block, 0, learner_.rollout()); });
}

void Training::resume() {
  const learner::Checkpoint checkpoint = learner::load_checkpoint(checkpoint_path_);
  std::uint64_t robot = 0;
  checkpoint.get("run.robot", &robot, 1);
  if (robot != robot_hash_) {
    throw InputError(
        fmt::format("{}: was made with another robot than this '{}'; continue with the same one",
                    checkpoint_path_, robot_.description.name));
  }
  if (checkpoint.config_hash != config_hash_) require_same_settings(checkpoint);
  restore(checkpoint);
  checkpoint.get("run.cpu_seconds", &cpu_before_s_, 1);
  Names origin{};
  checkpoint.get("run.origin", origin.data(), origin.size());
  origin_ = origin.data();
  if (checkpoint.config_hash != config_hash_) {
    if (ranks_.is_first()) {
      to_standard_error(fmt::format(
          "{}: run.transitions is larger than before: settling and late penalties follow the new "
          "length from here on. The weights will differ from those of a training of this length "
          "from the start.\n",
          checkpoint_path_));
    }
    origin_ += fmt::format(", made longer at {} transitions", learner_.transitions());
  }
  // All builds and processors that had a part in the weights.
  for (const auto& [section, now] :
       {std::pair{"run.builds", &builds_}, std::pair{"run.processors", &processors_}}) {
    Names names{};
    checkpoint.get(section, names.data(), names.size());
    std::string list = names.data();
    std::string_view rest = *now;
    while (!rest.empty()) {
      const std::size_t comma = std::min(rest.find(", "), rest.size());
      add_name(list, rest.substr(0, comma));
      rest.remove_prefix(std::min(comma + 2, rest.size()));
    }
    *now = list;
  }
}

// Throws InputError for settings other than the checkpoint's, but for a longer training.
void Training::require_same_settings(const learner::Checkpoint& checkpoint) const {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", checkpoint_path_, what));
  };
  const auto config = checkpoint.sections.find("run.config");
  if (config == checkpoint.sections.end()) {
    fail("was made with another config or seed; continue with the same ones");
  }
  const auto before = settings_in({config->second.data(), config->second.size()});
  const auto now = settings_in(config_.effective);
  std::vector<std::string> differ;
  const auto value_in = [](const auto& settings, const std::string& key) {
    const auto found = settings.find(key);
    return found == settings.end() ? std::string("nothing") : found->second;
  };
  const auto compare = [&](const auto& keys, bool unless_in_before) {
    for (const auto& [key, value] : keys) {
      if (unless_in_before && before.contains(key)) continue;
      const std::string was = value_in(before, key), is = value_in(now, key);
      if (was != is && key != "run.transitions") {
        differ.push_back(fmt::format("{} = {}, expected {}", key, is, was));
      }
    }
  };
  compare(before, false);
  compare(now, true);
  std::int64_t seed = 0;
  checkpoint.get("run.seed", &seed, 1);
  if (seed != static_cast<std::int64_t>(options_.seed)) {
    differ.push_back(fmt::format("--seed {}, expected {}", options_.seed, seed));
  }
  if (!differ.empty()) fail(fmt::format("found {}", fmt::join(differ, "; ")));
  double length = 0.0;
  checkpoint.get("run.transitions", &length, 1);
  if (config_.run.transitions < length) {
    fail(
        fmt::format("found run.transitions = {:.0f}, expected at least the {:.0f} of the "
                    "checkpoint: a training can only be made longer",
                    config_.run.transitions, length));
  }
}

void Training::restore(const learner::Checkpoint& checkpoint) {
  learner_.load(checkpoint);
  task_.load(checkpoint);
  gate_.load(checkpoint);
  progress_.load(checkpoint);
  checkpoint.get("battery.figures", &figures_, 1);
  checkpoint.get("battery.best", &best_, 1);
  best_parameters_.resize(best_.transitions > 0.0 ? learner_.averaged().size() : 0);
  checkpoint.get("battery.best_parameters", best_parameters_.data(), best_parameters_.size());
  best_is_written_ = best_parameters_.empty();  // a file may be missing, or later than this
}

void Training::save() {
  const double core_s = core_seconds();
  const Snapshot now = snapshot();
  saved_at_s_ = wall_seconds();
  fallbacks_ = 0;
  learner::Checkpoint checkpoint;
  learner_.save(checkpoint);
  task_.save(checkpoint);
  checkpoint.gather(ranks_, learner_.blocks());
  if (!ranks_.is_first()) return;
  gate_.save(checkpoint);
  progress_.save(checkpoint);
  checkpoint.put("battery.figures", &figures_, 1);
  checkpoint.put("battery.best", &best_, 1);
  checkpoint.put("battery.best_parameters", best_parameters_.data(), best_parameters_.size());
  checkpoint.put("run.cpu_seconds", &core_s, 1);
  checkpoint.put("run.robot", &robot_hash_, 1);
  for (const auto& [section, text] :
       {std::pair{"run.builds", &builds_}, std::pair{"run.processors", &processors_},
        std::pair{"run.origin", &origin_}}) {
    Names names{};
    text->copy(names.data(), names.size() - 1);
    checkpoint.put(section, names.data(), names.size());
  }
  const auto seed = static_cast<std::int64_t>(options_.seed);
  checkpoint.put("run.seed", &seed, 1);
  checkpoint.put("run.transitions", &config_.run.transitions, 1);
  checkpoint.put("run.config", config_.effective.data(), config_.effective.size());
  checkpoint.config_hash = config_hash_;
  learner::save_checkpoint(checkpoint, checkpoint_path_);
  write_policy_file(options_.out + "/policy.safetensors",
                    policy_file(policy_spec(now), learner_.averaged()));
  if (!best_is_written_) {
    PolicySpec best = policy_spec(best_);
    best.provenance["battery"] = Progress::summary(best_.battery);
    write_policy_file(options_.out + "/best.safetensors",
                      policy_file(std::move(best), best_parameters_));
    best_is_written_ = true;
  }
  progress_.write(options_.out);
  if (!config_.learner.network.wiring.sees_insight()) {
    const PolicyFile policy = policy_file(policy_spec(now), learner_.averaged());
    pool_.run(1, [&](int, int) {
      write_file(options_.out + "/curve.html",
                 curve_page(progress_, policy, now.transitions, robot_,
                            config_.task.command.speed_start_mps));
    });
  }
}

// Each rank reads the files itself.
void Training::require_same_state() const {
  const std::vector<float>& parameters = learner_.parameters();
  const std::string_view bytes(reinterpret_cast<const char*>(parameters.data()),
                               sizeof(float) * parameters.size());
  if (ranks_.agree(learner::fnv1a(bytes, config_hash_ ^ learner_.transitions()))) return;
  throw InputError(
      fmt::format("{}: found another state on another rank, expected the same settings and the "
                  "same file on all",
                  checkpoint_path_));
}

double Training::core_seconds() const { return cpu_before_s_ + ranks_.sum(cpu_seconds()); }

void Training::step_window() {
  const learner::Share own = learner_.own_blocks();
  pool_.run(own.size(), [&](int i, int worker) {
    const int block = own.begin + i;
    for (int t = 0; t < config_.window; ++t) {
      learner_.act_block(block, t, worker);
      task_.step(block, t, learner_.rollout());
    }
  });
}

void Training::run(const std::atomic<bool>& interrupted) {
  saved_at_s_ = wall_seconds();
  const double start_s = wall_seconds();
  require_same_state();
  const auto transitions = [&] { return static_cast<double>(learner_.transitions()); };
  const double before = transitions(), all = config_.run.transitions;
  while (transitions() < all && !ranks_.any(interrupted)) {
    const double t0_s = wall_seconds();
    settle();
    step_window();
    const double t1_s = wall_seconds();
    const learner::UpdateStats update = learner_.update();
    const double t2_s = wall_seconds();
    if (!update.finite) {
      fall_back();
      continue;
    }
    const double done = transitions();
    if (battery_ &&
        (learner_.updates() == 1 || done >= all ||
         learner_.updates() % static_cast<std::uint64_t>(config_.battery.every_updates) == 0)) {
      run_battery();
    }
    gate_.advance(done);
    task_.gather_window(ranks_);
    const WindowStats window = task_.end_window(done, gate_.late());
    const ProgressRow row = make_row(window, update, t1_s - t0_s, t2_s - t0_s);
    progress_.add(row);
    const double rate = (done - before) / (t2_s - start_s);
    if (ranks_.is_first() && (learner_.updates() % 10 == 1 || done >= all)) {
      fmt::print("{}\n", Progress::line(row, (all - done) / rate));
      std::fflush(stdout);
    }
    const bool is_due = t2_s - saved_at_s_ > config_.run.checkpoint_interval_s;
    if (ranks_.any(is_due && ranks_.is_first())) save();
  }
  if (transitions() > before) save();
}

std::string Training::verdict() const {
  if (!battery_) return "";
  const bool walks = figures_.alive >= kWalksAlive && figures_.error <= kWalksError;
  return fmt::format(
      "{:.0f} % of the battery's runs ended without a fall, velocity error {:.2f}: {}",
      100.0 * figures_.alive, figures_.error,
      walks ? "it walks"
            : fmt::format("not a gait yet (a gait has {:.0f} % and at most {:.2f})",
                          100.0 * kWalksAlive, kWalksError));
}

// Measures the averaged policy; keeps it if it is the best so far.
void Training::run_battery() {
  const double before_s = cpu_seconds();
  figures_ = battery_->run(learner_.averaged(), ranks_);
  battery_cpu_s_ += cpu_seconds() - before_s;
  gate_.judge(figures_);
  const Snapshot now = snapshot();
  if (best_parameters_.empty() || score(figures_) > score(best_.battery)) {
    best_ = now;
    best_parameters_ = learner_.averaged();
    best_is_written_ = false;
  }
}

// Compared with all batteries so far, the latest among them.
double Training::score(const BatteryFigures& figures) const {
  return score_of(figures, config_.battery, std::max(progress_.most_alive(), figures_.alive));
}

Snapshot Training::snapshot() const {
  return {.transitions = static_cast<double>(learner_.transitions()),
          .core_hours = core_seconds() / 3600.0,
          .command_speed_mps = task_.curriculum().speed_mps,
          .battery = figures_};
}

// In the last part smaller and smaller updates, less and less noise, and more starts: the policy
// settles.
void Training::settle() {
  const RunSettings& run = config_.run;
  const learner::LearnerConfig& learner = config_.learner;
  const double left = gate_.unsettled();
  learner_.set_symmetry_weight(learner.loss.symmetry_weight * gate_.late());
  learner_.set_kl_target(std::max(left, run.settle_kl_share) * learner.kl_target);
  learner_.set_action_std_most(run.settle_action_std *
                               std::pow(learner.action_std_start / run.settle_action_std, left));
  task_.set_soft_reset_share(
      std::lerp(run.settle_soft_reset_share, config_.task.episode.soft_reset_share, left));
}

void Training::fall_back() {
  if (!std::filesystem::exists(checkpoint_path_)) {
    throw std::runtime_error("an update is not finite, before the first checkpoint");
  }
  if (++fallbacks_ > kMostFallbacks) {
    throw std::runtime_error(fmt::format(
        "no finite update from {} on, with smaller and smaller learning rates", checkpoint_path_));
  }
  if (ranks_.is_first()) {
    to_standard_error(fmt::format("update {} is not finite: back to {}, slower\n",
                                  learner_.updates(), checkpoint_path_));
  }
  restore(learner::load_checkpoint(checkpoint_path_));
  require_same_state();
  // The same steps would end in the same bits.
  for (int i = 0; i < fallbacks_; ++i) learner_.halve_learning_rate();
}

ProgressRow Training::make_row(const WindowStats& window, const learner::UpdateStats& update,
                               double simulation_s, double total_s) const {
  ProgressRow r;
  r.iteration = static_cast<double>(learner_.updates());
  r.transitions = static_cast<double>(learner_.transitions());
  r.core_hours = core_seconds() / 3600.0;
  r.transitions_per_s = config_.run.envs * config_.window / total_s;
  r.simulation_share = simulation_s / total_s;
  r.window = window;
  const auto& deviation = task_.scales().estimate_deviation;
  r.estimate_vx_rms_mps = update.estimate_rms[1] * static_cast<double>(deviation[1]);
  r.estimate_height_rms_m = update.estimate_rms[0] * static_cast<double>(deviation[0]);
  r.command_speed_mps = task_.curriculum().speed_mps;
  r.ground_open = task_.curriculum().ground;
  r.battery = figures_;
  r.score = score(figures_);
  r.battery_share = battery_cpu_s_ / cpu_seconds();
  r.late = gate_.late();
  r.settled = 1.0 - gate_.unsettled();
  r.learning_rate = update.learning_rate;
  r.kl = update.kl;
  r.action_std = update.action_std;
  r.asymmetry = update.asymmetry;
  r.imitation_rms = update.imitation_rms;
  r.encoding_rms = update.encoding_rms;
  r.explained_variance = update.explained_variance;
  return r;
}

}  // namespace sandrunner::train
