// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "rt/base/command_line.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {

std::optional<Options> parse_options(int argc, const char* const* argv) {
  Options o;
  o.lab.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::string> all;
  for (const Experiment& e : experiments()) all.emplace_back(e.key);
  std::vector<std::string> only = all;
  CLI::App app{
      "Runs the paper's experiments on trained controllers and writes one page: tables and "
      "figures, the paper's numbers next to ours, and a verdict for each claim.",
      "sandrunner-study"};
  app.add_option("--from", o.from, "folder with NAME-SEED.safetensors")
      ->type_name("DIR")
      ->required();
  app.add_option("--out", o.out, "folder for report.html, results.json, claims.csv and pictures")
      ->type_name("DIR")
      ->required();
  app.add_option("--only", only,
                 fmt::format("some of {}", fmt::join(all.begin() + 1, all.end(), ",")))
      ->delimiter(',')
      ->check(CLI::IsMember(all))
      ->type_name("E1,...");
  app.add_option("--seeds", o.seeds, "training seeds (default: all that are there)")
      ->delimiter(',')
      ->check(CLI::Range(1, 1'000'000'000))
      ->type_name("1,...");
  app.add_option("--runs", o.lab.runs, "runs of each ground and command")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  app.add_option(
         "--grid-runs", o.lab.grid_runs,
         "robots in each cell of E7's grid; with fewer than the paper's 360, E8 has fewer too")
      ->check(CLI::Range(1, 100'000))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--grid-cells", o.lab.grid_cells,
                 "cells of the grid each way; claims need the paper's 10")
      ->check(CLI::Range(2, 100))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--threads", o.lab.threads, "worker threads; the results do not depend on them")
      ->check(CLI::Range(1, 1024))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--published", o.published,
                 "the authors' network, as a policy file: shown next to ours, in no verdict")
      ->type_name("FILE");
  app.add_option("--contact", o.contact, "what `sandrunner-bench contact --json FILE` wrote")
      ->type_name("FILE");
  app.footer(
      "An experiment that is done is kept in OUT/cache, so the same command goes on after an\n"
      "interruption. Examples:\n"
      "  sandrunner-study --from tools/study/trained --out report\n"
      "  sandrunner-study --from tools/study/trained --only E1,E5 --runs 8 --out quick");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  for (const std::string& key : all) {
    const bool chosen = std::find(only.begin(), only.end(), key) != only.end();
    if (chosen || key == "fairness") o.only.push_back(key);
  }
  return o;
}

}  // namespace sandrunner::study
