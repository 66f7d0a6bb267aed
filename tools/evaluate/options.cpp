// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "rt/base/command_line.h"

namespace sandrunner::evaluate {

std::optional<Options> parse_options(int argc, const char* const* argv) {
  Options o;
  o.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::string> all_parts, chosen;
  for (const PartRow& row : kParts) all_parts.emplace_back(row.name);
  std::string line = "on";
  CLI::App app{
      "Measures how well a policy runs, in simulation; compares two policies on the same starts, "
      "commands and disturbances.",
      "sandrunner-evaluate"};
  app.option_defaults()->always_capture_default();
  app.add_option("--policy", o.policy_path, "policy file")->type_name("FILE")->required();
  app.add_option("--against", o.against_path, "second policy file, to compare with")
      ->type_name("FILE");
  app.add_option("--robot", o.robot,
                 "raibo, go2, or the robot file of another one (sim/robot/README.md)")
      ->type_name("NAME|FILE");
  app.add_option("--out", o.out_dir, "folder for evaluation.json and CSV files")->type_name("DIR");
  app.add_option("--threads", o.threads, "worker threads; the results do not depend on them")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  app.add_option("--runs", o.study.runs, "runs of each ground, command and scenario")
      ->check(CLI::Range(1, 100'000))
      ->type_name("N");
  app.add_option("--grid-runs", o.study.grid_runs, "robots in each cell of the stiffness grid")
      ->check(CLI::Range(1, 100'000))
      ->type_name("N");
  app.add_option("--seed", o.study.seed, "seed of starts, noise, pushes and random commands")
      ->check(CLI::Range(1, 1'000'000'000))
      ->type_name("N");
  app.add_option("--only", chosen, "some of " + fmt::format("{}", fmt::join(all_parts, ",")))
      ->delimiter(',')
      ->check(CLI::IsMember(all_parts))
      ->type_name("PART,...")
      ->always_capture_default(false);
  app.add_option("--torque-speed-line", line, "drives lose torque towards their no-load speed")
      ->check(CLI::IsMember({"on", "off"}))
      ->type_name("on|off");
  app.footer(
      "Examples:\n"
      "  sandrunner-evaluate --policy mine.safetensors --out results\n"
      "  sandrunner-evaluate --policy mine.safetensors --against theirs.safetensors --only "
      "straight");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  for (const PartRow& row : kParts) {
    const bool is_chosen = std::find(chosen.begin(), chosen.end(), row.name) != chosen.end();
    if (chosen.empty() || is_chosen) o.parts.push_back(row);
  }
  o.torque_speed_line = line == "on";
  return o;
}

}  // namespace sandrunner::evaluate
