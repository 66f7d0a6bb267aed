// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-evaluate: measures policies. This file wires and reports progress.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "tools/evaluate/files.h"
#include "tools/evaluate/options.h"
#include "tools/evaluate/runner.h"
#include "tools/evaluate/tables.h"

namespace sandrunner::evaluate {
namespace {

std::vector<std::vector<TrialFigures>> run_part(const Study& study, const Part& part,
                                                const Policy& policy, const std::string& name,
                                                const RunnerSettings& settings) {
  std::vector<Trial> trials;
  for (const Group& group : part.groups) {
    trials.insert(trials.end(), group.trials.begin(), group.trials.end());
  }
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (!terminal) to_standard_error(fmt::format("{} {}: {} runs\n", part.name, name, trials.size()));
  const auto progress = [&](std::size_t done) {
    to_standard_error(
        fmt::format("\r{:<8} {:<20} {:6} of {} runs ", part.name, name, done, trials.size()));
  };
  const std::vector<TrialFigures> all =
      run_trials(study.robot(), study.foot(), policy, trials, settings,
                 terminal ? progress : std::function<void(std::size_t)>());
  if (terminal) to_standard_error(fmt::format("\r{:60}\r", ""));
  std::vector<std::vector<TrialFigures>> groups;
  auto at = all.begin();
  for (const Group& group : part.groups) {
    const auto end = at + static_cast<std::ptrdiff_t>(group.trials.size());
    groups.emplace_back(at, end);
    at = end;
  }
  return groups;
}

// Two of the same name are called by their files: "first/best", "trained/raibo".
void tell_apart(std::vector<std::string>& names, const std::vector<std::string>& paths) {
  if (names.size() < 2 || names[0] != names[1]) return;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::filesystem::path path = std::filesystem::absolute(paths[i]);
    names[i] = (path.parent_path().filename() / path.stem()).string();
  }
  if (names[0] == names[1]) names[1] += " (2)";
}

int run(int argc, char** argv) {
  const std::optional<Options> options = parse_options(argc, argv);
  if (!options) return kExitOk;
  const sim::Robot robot = sim::load_robot(options->robot);
  std::vector<Policy> policies = {load_policy(options->policy_path)};
  if (!options->against_path.empty()) policies.push_back(load_policy(options->against_path));
  for (const Policy& policy : policies) require_joints(policy.spec(), robot.description);
  const std::string dir = options->out_dir + "/";
  const bool out = !options->out_dir.empty();
  if (out) prepare_folder(options->out_dir, "--out");

  Results results;
  for (const Policy& policy : policies) {
    results.policies.push_back(policy.spec().name);
    results.envelopes.push_back(policy.spec().envelope);
  }
  tell_apart(results.policies, {options->policy_path, options->against_path});
  Study study(options->study, robot);
  RunnerSettings settings;
  settings.threads = options->threads;
  settings.torque_speed_line = options->torque_speed_line;
  for (const PartRow& row : options->parts) {
    PartResults part{(study.*row.make)(), {}};
    for (std::size_t p = 0; p < policies.size(); ++p) {
      part.runs.push_back(run_part(study, part.part, policies[p], results.policies[p], settings));
    }
    fmt::print("{}\n", tables(part, results.policies));
    std::fflush(stdout);
    results.parts.push_back(std::move(part));
  }
  // All at the end: an evaluation that is cut short leaves the files of the one before as they are.
  if (out) {
    for (const PartResults& part : results.parts) {
      write_file(dir + part.part.name + ".csv", part_csv(part, results.policies));
    }
    write_file(dir + "evaluation.json", results_json(results, robot.description.name, *options));
    fmt::print("wrote evaluation.json and the parts' files into {}\n", options->out_dir);
  }
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner::evaluate

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-evaluate",
                                 [&] { return sandrunner::evaluate::run(argc, argv); });
}
