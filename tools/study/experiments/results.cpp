// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "rt/base/build.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"
#include "rt/report/run_csv.h"
#include "tools/study/experiments/anchors.h"
#include "tools/study/experiments/experiments.h"
#include "tools/study/experiments/recovery_run.h"
#include "tools/study/experiments/training_settings.h"

namespace sandrunner::study {
namespace {

// The columns of a short learning curve, by name; null where a cell is no number. Empty without a
// file.
Json curve_json(const std::string& path) {
  Json columns = Json::object();
  if (!std::filesystem::exists(path)) return columns;
  std::istringstream lines(read_input_file(path, "a learning curve"));
  std::string line, cell;
  std::vector<std::string> names;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    const bool heading = names.empty();
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (heading) {
        names.push_back(cell);
      } else if (i < names.size()) {
        char* end = nullptr;
        const double value = std::strtod(cell.c_str(), &end);
        columns[names[i]].push_back(end == cell.c_str() ? std::nan("") : value);
      }
    }
  }
  return columns;
}

Json model_json(const Model& model, const Options& options, const sim::Robot& robot) {
  const auto& provenance = model.network.spec.provenance;
  Json settings = Json::array();
  if (const auto config = provenance.find("config"); config != provenance.end()) {
    for (const SettingDifference& d : settings_that_differ(config->second, robot)) {
      settings.push_back({{"key", d.key}, {"value", d.value}, {"usual", d.usual}});
    }
  }
  return {{"controller", model.controller->key},
          {"seed", model.seed},
          {"hash", fmt::format("{:016x}", model.hash)},
          {"provenance", provenance},
          {"length", training_length(model)},
          {"settings", settings},
          {"curve", curve_json(fmt::format("{}/{}.csv", options.from, model_name(model)))}};
}

Json experiments_json(const Measurements& measurements) {
  Json json = Json::object();
  for (const auto& [experiment, controllers] : measurements) {
    for (const auto& [controller, seeds] : controllers) {
      for (const auto& [seed, measured] : seeds) {
        json[experiment][controller][std::to_string(seed)] = to_json(measured);
      }
    }
  }
  return json;
}

void add_drop(Json& drops, double impact_mps, const Stop& stop) {
  drops["impact_mps"].push_back(impact_mps);
  drops["depth_mm"].push_back(1e3 * stop.depth_m);
  drops["time_ms"].push_back(1e3 * stop.time_s);
}

Json ground_json() {
  Json json;
  for (const Anchor& a : ground_anchors()) {
    json["anchors"].push_back({{"experiment", a.experiment},
                               {"source", a.source},
                               {"quantity", a.quantity},
                               {"published", a.published},
                               {"ours", a.ours},
                               {"digits", a.digits}});
  }
  Json& ball = json["ball"];
  for (int i = 0; i <= 35; ++i) {
    const double v = 0.5 + 0.1 * i;
    add_drop(ball["published"], v, katsuragi_durian(v));
  }
  for (int i = 1; i <= 8; ++i)
    add_drop(ball["ours"], 0.5 * i, drop_ball({}, glass_beads(), 0.5 * i));
  return json;
}

// Null if E2 was not run, or if no start has such a run.
Json recovery_run_json(const Options& options, const std::vector<Model>& models,
                       const Measurements& measurements) {
  const auto ours = std::ranges::find_if(
      models, [](const Model& m) { return std::string_view(m.controller->key) == "ours"; });
  if (!measurements.contains("E2") || ours == models.end()) return nullptr;
  std::optional<RecoveryRun> run = find_recovery_run(Lab(options.lab), *ours);
  if (!run) return nullptr;
  Json json = recovery_curves(*run);
  json["start"] = run->seed;
  json["touchdown_s"] = run->met_s;
  json["seed"] = ours->seed;
  write_csv(run->record, options.out + "/recovery.csv");
  write_file(options.out + "/recovery.html", recovery_page(std::move(*run)));
  return json;
}

// Without what changes no result: --out and --threads.
std::string command(const Options& options) {
  const std::vector<std::string> only(options.only.begin() + 1,
                                      options.only.end());  // no "fairness"
  std::string words = fmt::format("sandrunner-study --from {} --only {} --runs {}", options.from,
                                  fmt::join(only, ","), options.lab.runs);
  if (!options.seeds.empty()) words += fmt::format(" --seeds {}", fmt::join(options.seeds, ","));
  words +=
      fmt::format(" --grid-runs {} --grid-cells {}", options.lab.grid_runs, options.lab.grid_cells);
  if (!options.published.empty()) words += " --published " + options.published;
  if (!options.contact.empty()) words += " --contact " + options.contact;
  return words;
}

}  // namespace

void write_results(const Options& options, const std::vector<Model>& models,
                   const Measurements& measurements, const Json& contact) {
  Json json = {{"build", build_name()},
               {"command", command(options)},
               {"runs", options.lab.runs},
               {"grid_runs", options.lab.grid_runs},
               {"grid_cells", options.lab.grid_cells}};
  const sim::Robot robot = sim::load_raibo();
  for (const Model& model : models) {
    json["models"][model_name(model)] = model_json(model, options, robot);
  }
  for (const Experiment& e : experiments()) json["takes_part"][e.key] = e.controllers;
  json["experiments"] = experiments_json(measurements);
  json["contact"] = contact;
  json["recovery_run"] = recovery_run_json(options, models, measurements);
  json["ground"] = ground_json();
  write_file(options.out + "/results.json",
             json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace sandrunner::study
