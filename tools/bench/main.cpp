// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-bench: how fast parts of sandrunner are on this machine.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "tools/bench/benches.h"
#include "tools/bench/contact_bench.h"

namespace sandrunner {
namespace {

int run(int argc, char** argv) {
  CLI::App app("Measures how fast sandrunner is on this machine.", "sandrunner-bench");
  app.require_subcommand(1);

  std::string json_path, hardware;
  int rounds = 11;
  CLI::App* batch = app.add_subcommand(
      "batch", "steps per second of robots trotting on sand, against MuJoCo in the same run");
  CLI::App* contact = app.add_subcommand(
      "contact", "time of dynamic resistive force theory over that of the cone model, same drops");
  CLI::App* learner = app.add_subcommand(
      "learner", "GFLOP/s of the training's matrix products, against Eigen and this core's peak");
  CLI::App* rt = app.add_subcommand(
      "rt", "wake-up of the control thread against cyclictest, policy step against a read floor");
  CLI::App* unitree = app.add_subcommand(
      "unitree", "tick of the control thread of a Unitree robot over DDS, against one without DDS");
  unitree
      ->add_option("--hardware", hardware, "file of kind unitree; its interface is taken to be lo")
      ->type_name("FILE")
      ->required();
  for (CLI::App* command : {batch, contact, learner, rt, unitree}) {
    command->add_option("--json", json_path, "file for the figures")->type_name("FILE");
    command->add_option("--rounds", rounds, "interleaved rounds")
        ->check(CLI::Range(1, 10000))
        ->type_name("N")
        ->capture_default_str();
  }

  app.footer("Example:\n  sandrunner-bench rt --rounds 5 --json rt.json");
  if (!parse_command_line(app, argc, argv)) return kExitOk;
  // Made now: a place that cannot be written is found before the measurement.
  std::optional<WholeFile> file;
  if (!json_path.empty()) file.emplace(json_path);
  bench::Report report;
  if (batch->parsed()) report = bench::run_batch_bench(rounds);
  if (contact->parsed()) report = bench::run_contact_bench(rounds);
  if (learner->parsed()) report = bench::run_learner_bench(rounds);
  if (rt->parsed()) {
    report = bench::run_policy_bench(rounds);
    bench::run_wakeup_bench(rounds, report);
  }
  if (unitree->parsed()) report = bench::run_unitree_bench(hardware, rounds);
  print(report);
  if (file) {
    file->write(to_json(report));
    file->keep();
  }
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-bench", [&] { return sandrunner::run(argc, argv); });
}
