// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-train: trains a policy from random weights on randomised deformable ground. This file
// parses and wires.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "tools/train/join_ranks.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/training.h"

namespace sandrunner::train {
namespace {

constexpr const char* kDefaultRobot = "raibo";

std::atomic<bool> interrupted{false};

// What came of it, where the policy is, and how to go on.
void print_end(const Training& training, const std::string& out, const std::string& robot,
               bool are_a_robots) {
  const std::string verdict = training.verdict();
  if (!verdict.empty()) fmt::print("{}\n", verdict);
  std::string policy = out + "/best.safetensors";
  if (!std::filesystem::exists(policy)) policy = out + "/policy.safetensors";
  if (are_a_robots) {
    const std::string of_robot = robot == kDefaultRobot ? "" : "--robot " + robot + " ";
    fmt::print("wrote {}: look at {}/curve.html, run it with sandrunner {}--policy {}\n", out, out,
               of_robot, policy);
  } else {
    fmt::print("wrote {}: no robot runs the networks of {}\n", out, policy);
  }
  if (interrupted) fmt::print("interrupted: go on with the same command and --resume\n");
}

// The battery of these settings, with the networks of a file.
void judge(const TrainConfig& config, const sim::Robot& robot, const std::string& file,
           int threads) {
  const TaskNetwork network =
      make_task_network(read_policy_file(file), config.task.policy.mode_gain);
  require_joints(network.spec, robot.description);
  WorkerPool pool(threads);
  Battery battery(config.battery, config.task, config.learner.block_envs, robot, network.layout,
                  pool);
  const BatteryFigures figures = battery.run(network.parameters);
  fmt::print("{}\n{:<14}", Progress::summary(figures), "alive at, m/s");
  for (const double share : config.battery.forward_share) {
    fmt::print(" {:>7.2f}", share * config.task.command.speed_max_mps);
  }
  for (const Battery::Survival& row : battery.survival()) {
    fmt::print("\n{:<14}", row.ground);
    for (const int alive : row.alive) {
      fmt::print(" {:>7}", fmt::format("{}/{}", alive, config.battery.runs));
    }
  }
  fmt::print("\n");
}

struct Arguments {
  TrainingOptions options;
  std::string config_file, from_file, judged_file, robot_name = kDefaultRobot;
  std::vector<std::string> assignments;
  bool resume = false, explain = false;
};

// Nothing if the command line asked for help alone.
std::optional<Arguments> parse(int argc, char** argv) {
  Arguments a;
  a.options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  CLI::App app{"Trains a policy from random weights on randomised deformable ground.",
               "sandrunner-train"};
  app.add_option(
         "--out", a.options.out,
         "folder for checkpoint.bin, policy.safetensors, best.safetensors, curve.csv, curve.html "
         "(required)")
      ->type_name("DIR");
  app.add_option(
         "--config", a.config_file,
         "TOML with settings that differ from the built-in ones (tools/train/training.toml)")
      ->type_name("FILE");
  app.add_option("--robot", a.robot_name,
                 "robot to train: raibo, go2, or the robot file of another one "
                 "(sim/robot/README.md)")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  app.add_option("--set", a.assignments, "one setting; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  app.add_option("--threads", a.options.threads,
                 "worker threads; the weights do not depend on them")
      ->check(CLI::Range(1, 256))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--seed", a.options.seed, "seed of the weights and environments")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N")
      ->capture_default_str();
  app.add_flag("--resume", a.resume, "continue from the checkpoint in --out");
  app.add_option("--from", a.from_file,
                 "policy file to go on from instead of random weights: for other ground or another "
                 "robot")
      ->type_name("FILE");
  app.add_option("--judge", a.judged_file,
                 "run the battery of these settings with a policy file, and end")
      ->type_name("FILE");
  app.add_flag("--explain", a.explain, "say what the lines of progress mean, and end");
  app.footer(
      "Examples:\n"
      "  sandrunner-train --out runs/a --seed 2\n"
      "  sandrunner-train --out runs/a --resume");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  if (!a.explain && a.judged_file.empty() && a.options.out.empty()) {
    throw InputError("--out: found none, expected a folder");
  }
  if (a.resume && !a.from_file.empty()) {
    throw InputError("--from: expected without --resume, which has weights of its own");
  }
  return a;
}

int run(const Arguments& a) {
  if (a.explain) {
    fmt::print("{}", Progress::explanation());
    return kExitOk;
  }
  const std::string& out = a.options.out;
  ConfigTree tree;
  const sim::Robot robot = sim::load_robot(a.robot_name);
  add_training_layers(tree, robot);
  if (!a.config_file.empty()) tree.add_file(a.config_file);
  for (const std::string& assignment : a.assignments) tree.set(assignment);
  const TrainConfig config = read_train_config(tree);
  check_robot(config.task, robot);
  if (!a.judged_file.empty()) {
    judge(config, robot, a.judged_file, a.options.threads);
    return kExitOk;
  }
  if (!a.resume && std::filesystem::exists(Training::checkpoint_path(out))) {
    throw InputError(
        fmt::format("--out: '{}' holds a training; give --resume or another folder", out));
  }
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  const std::unique_ptr<learner::Exchange> exchange = join_ranks();
  TrainingOptions options = a.options;
  if (exchange) options.ranks = learner::Ranks(*exchange);
  Training training(config, robot, options);
  if (!a.from_file.empty()) training.go_on_from(read_policy_file(a.from_file));
  if (a.resume) training.resume();
  if (options.ranks.is_first()) prepare_folder(out, "--out");
  if (!a.resume) training.start();
  if (options.ranks.is_first()) {
    fmt::print("sandrunner-train --explain says what the lines of progress mean\n");
    std::fflush(stdout);
  }
  const auto begin = std::chrono::steady_clock::now();
  training.run(interrupted);
  if (!options.ranks.is_first()) return kExitOk;
  if (exchange) {
    const std::chrono::duration<double> all = std::chrono::steady_clock::now() - begin;
    const auto [got_bytes, time_s] = exchange->traffic();
    fmt::print("{} ranks: each got {:.1f} MB from the others, {:.1f} % of the time with waiting\n",
               options.ranks.size(), 1e-6 * got_bytes, 100.0 * time_s / all.count());
  }
  print_end(training, out, a.robot_name, !config.learner.network.wiring.sees_insight());
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner::train

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-train", [&] {
    const auto arguments = sandrunner::train::parse(argc, argv);
    return arguments ? sandrunner::train::run(*arguments) : sandrunner::kExitOk;
  });
}
