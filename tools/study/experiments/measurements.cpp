// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "rt/base/output_files.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

std::string cache_path(const Options& options, const Experiment& experiment, const Model& model) {
  return fmt::format("{}/cache/{}-{}.json", options.out, experiment.key, model_name(model));
}

std::string cache_key(const Options& options, const Experiment& experiment, const Model& model) {
  const LabSettings& lab = options.lab;
  const std::string_view experiment_key = experiment.key;
  const bool on_task = experiment_key == "E7" || experiment_key == "E8";
  const std::string runs = on_task ? fmt::format("{} robots, {} x {} cells", lab.grid_runs,
                                                 lab.grid_cells, lab.grid_cells)
                                   : fmt::format("{} runs", lab.runs);
  return fmt::format("version {}, model {:016x}, {}", kMeasurementVersion, model.hash, runs);
}

// What the file holds under the key; nothing if it is absent, of another key or damaged.
std::optional<Measured> read_cache(const std::string& path, const std::string& key) {
  std::ifstream file(path, std::ios::binary);
  try {
    const Json json = Json::parse(file);
    if (json.at("key") == key) return measured_from(json.at("measured"));
  } catch (const Json::exception&) {
  }
  return std::nullopt;
}

bool takes_part(const Experiment& experiment, const Model& model) {
  return std::any_of(experiment.controllers.begin(), experiment.controllers.end(),
                     [&](std::string_view key) { return key == model.controller->key; });
}

}  // namespace

Measurements measure(const Options& options, const std::vector<Model>& models) {
  Measurements measurements;
  prepare_folder(options.out + "/cache", "--out");
  Lab lab(options.lab);
  for (const Experiment& experiment : experiments()) {
    if (std::ranges::find(options.only, experiment.key) == options.only.end()) continue;
    int ran = 0, kept = 0;
    for (const Model& model : models) {
      if (!takes_part(experiment, model)) continue;
      const std::string path = cache_path(options, experiment, model);
      const std::string key = cache_key(options, experiment, model);
      std::optional<Measured> measured = read_cache(path, key);
      if (measured) {
        ++kept;
      } else {
        ++ran;
        measured = experiment.run(lab, model);
        write_file(path, Json{{"key", key}, {"measured", to_json(*measured)}}.dump() + "\n");
      }
      measurements[experiment.key][model.controller->key][model.seed] = std::move(*measured);
    }
    fmt::print("{}: {} models run, {} taken from an earlier run\n", experiment.key, ran, kept);
    std::fflush(stdout);
  }
  return measurements;
}

}  // namespace sandrunner::study
