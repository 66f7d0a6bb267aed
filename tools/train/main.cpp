// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-train: trains a policy from random weights on randomised deformable ground. This file
// parses and wires.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/training.h"

namespace sandrunner::train {
namespace {

constexpr const char* kDefaultRobot = "raibo";

std::atomic<bool> interrupted{false};

// Where the policy is, and how to go on.
void print_end(const std::string& out, const std::string& robot, bool are_a_robots) {
  std::string policy = out + "/best.safetensors";
  if (!std::filesystem::exists(policy)) policy = out + "/policy.safetensors";
  if (are_a_robots) {
    const std::string of_robot = robot == kDefaultRobot ? "" : "--robot " + robot + " ";
    fmt::print("wrote {}: run it with sandrunner {}--policy {}\n", out, of_robot, policy);
  } else {
    fmt::print("wrote {}: no robot runs {}, a study model\n", out, policy);
  }
  if (interrupted) fmt::print("interrupted: go on with the same command and --resume\n");
}

// The battery of these settings, with the networks of a file.
void judge(const TrainConfig& config, const sim::Robot& robot, const std::string& file,
           int threads) {
  const TaskNetwork network = read_task_network(file, config.task.policy.mode_gain);
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

int run(int argc, char** argv) {
  TrainingOptions options;
  options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::string config_file, from_file, judged_file, robot_name = kDefaultRobot;
  std::vector<std::string> assignments;
  bool resume = false, explain = false;
  CLI::App app{"Trains a policy from random weights on randomised deformable ground.",
               "sandrunner-train"};
  app.add_option(
         "--out", options.out,
         "folder for checkpoint.bin, policy.safetensors, best.safetensors, curve.csv, curve.html, "
         "curve.png (required)")
      ->type_name("DIR");
  app.add_option(
         "--config", config_file,
         "TOML with settings that differ from the built-in ones (tools/train/training.toml)")
      ->type_name("FILE");
  app.add_option("--robot", robot_name,
                 "robot to train: raibo, go2, or the robot file of another one "
                 "(sim/robot/README.md)")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  app.add_option("--set", assignments, "one setting; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  app.add_option("--threads", options.threads, "worker threads; the weights do not depend on them")
      ->check(CLI::Range(1, 256))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "seed of the weights and environments")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N")
      ->capture_default_str();
  app.add_flag("--resume", resume, "continue from the checkpoint in --out");
  app.add_option("--from", from_file,
                 "policy file to go on from instead of random weights: for other ground or another "
                 "robot")
      ->type_name("FILE");
  app.add_option("--judge", judged_file,
                 "run the battery of these settings with a policy file or study model, and end")
      ->type_name("FILE");
  app.add_flag("--explain", explain, "say what the lines of progress mean, and end");
  app.footer(
      "Examples:\n"
      "  sandrunner-train --out runs/a --seed 2\n"
      "  sandrunner-train --out runs/a --resume");
  if (!parse_command_line(app, argc, argv)) return kExitOk;
  if (explain) {
    fmt::print("{}", Progress::explanation());
    return kExitOk;
  }
  if (judged_file.empty() && options.out.empty())
    throw InputError("--out: found none, expected a folder");
  if (resume && !from_file.empty()) {
    throw InputError("--from: expected without --resume, which has weights of its own");
  }
  ConfigTree tree;
  const sim::Robot robot = sim::load_robot(robot_name);
  add_training_layers(tree, robot);
  if (!config_file.empty()) tree.add_file(config_file);
  for (const std::string& assignment : assignments) tree.set(assignment);
  const TrainConfig config = read_train_config(tree);
  check_robot(config.task, robot);
  if (!judged_file.empty()) {
    judge(config, robot, judged_file, options.threads);
    return kExitOk;
  }
  if (!resume && std::filesystem::exists(Training::checkpoint_path(options.out))) {
    throw InputError(
        fmt::format("--out: '{}' holds a training; give --resume or another folder", options.out));
  }
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  Training training(config, robot, options);
  if (!from_file.empty()) training.go_on_from(read_policy_file(from_file));
  if (resume) training.resume();
  prepare_folder(options.out, "--out");
  if (!resume) training.start();
  fmt::print("sandrunner-train --explain says what the lines of progress mean\n");
  std::fflush(stdout);
  training.run(interrupted);
  print_end(options.out, robot_name, config.learner.network.are_a_robots());
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner::train

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-train",
                                 [&] { return sandrunner::train::run(argc, argv); });
}
