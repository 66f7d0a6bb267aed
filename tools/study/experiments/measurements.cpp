// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "rt/base/build.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/output_files.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

/// Of this program's own bytes: a measurement by another build may differ.
std::uint64_t hash_of_program() {
  std::ifstream file("/proc/self/exe", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return hash_of(bytes);
}

std::string cache_path(const Options& options, const Experiment& experiment, const Model& model) {
  return fmt::format("{}/cache/{}-{}.json", options.out, experiment.key, model_name(model));
}

std::string cache_key(const Options& options, const Experiment& experiment, const Model& model,
                      std::uint64_t program) {
  const LabSettings& lab = options.lab;
  const std::string_view experiment_key = experiment.key;
  const bool on_task = experiment_key == "E7" || experiment_key == "E8";
  const std::string runs = on_task ? fmt::format("{} robots, {} x {} cells", lab.grid_runs,
                                                 lab.grid_cells, lab.grid_cells)
                                   : fmt::format("{} runs", lab.runs);
  return fmt::format("{:016x} {:016x} {}", program, model.hash, runs);
}

// What the file holds under the key; nothing if it is absent, of another key or damaged.
std::optional<Measured> read_cache(const std::string& path, const std::string& key) {
  std::ifstream file(path, std::ios::binary);
  const Json json = Json::parse(file, nullptr, false);
  if (json.is_discarded() || !json.is_object() || json.value("key", "") != key) return std::nullopt;
  return measured_from(json.at("measured"));
}

bool takes_part(const Experiment& experiment, const Model& model) {
  return std::any_of(experiment.controllers.begin(), experiment.controllers.end(),
                     [&](std::string_view key) { return key == model.controller->key; });
}

// "final depth 14.4 (quartiles 11.8 and 17.8), their range over it 0.42; ..."
double spread_in(const std::string& text, const std::string& path) {
  constexpr std::string_view kBefore = "their range over it ";
  const std::size_t at = text.find(kBefore);
  double spread = 0.0;
  if (at == std::string::npos ||
      std::sscanf(text.c_str() + at + kBefore.size(), "%lf", &spread) != 1) {
    throw InputError(
        fmt::format("--contact {}: found '{}', expected '{}' and a number", path, text, kBefore));
  }
  return spread;
}

}  // namespace

Evidence measure(const Options& options, const std::vector<Model>& models) {
  Evidence evidence;
  if (!options.contact.empty()) evidence.contact = read_contact_bench(options.contact);
  prepare_folder(options.out + "/cache", "--out");
  const std::uint64_t program = hash_of_program();
  Lab lab(options.lab);
  for (const std::string& name : options.only) {
    const Experiment& experiment = *find_experiment(name);
    int ran = 0, kept = 0;
    for (const Model& model : models) {
      if (!takes_part(experiment, model)) continue;
      const std::string path = cache_path(options, experiment, model);
      const std::string key = cache_key(options, experiment, model, program);
      std::optional<Measured> measured = read_cache(path, key);
      if (measured) {
        ++kept;
      } else {
        ++ran;
        measured = experiment.run(lab, model);
        write_file(path, Json{{"key", key}, {"measured", to_json(*measured)}}.dump() + "\n");
      }
      evidence.measured[name][model.controller->key][model.seed] = std::move(*measured);
    }
    fmt::print("{}: {} models run, {} taken from an earlier run\n", name, ran, kept);
    std::fflush(stdout);
  }
  return evidence;
}

ContactBench read_contact_bench(const std::string& path) {
  const Json json = Json::parse(read_input_file(path, "a file of sandrunner-bench contact --json"),
                                nullptr, false);
  ContactBench bench;
  try {
    bench.ratio = json.at("drft_vs_cone").at("median").get<double>();
    for (auto [key, text] : {std::pair{"processor", &bench.processor},
                             {"cone_mm", &bench.cone_mm},
                             {"drft_mm", &bench.drft_mm},
                             {"planar_mm", &bench.planar_mm}}) {
      *text = json.at(key).get<std::string>();
    }
  } catch (const Json::exception&) {
    throw InputError(fmt::format(
        "--contact {}: found something else, expected what `sandrunner-bench contact --json FILE` "
        "writes",
        path));
  }
  bench.spread_cone = spread_in(bench.cone_mm, path);
  bench.spread_drft = spread_in(bench.drft_mm, path);
  bench.spread_planar = spread_in(bench.planar_mm, path);
  return bench;
}

std::string results_json(const Options& options, const std::vector<Model>& models,
                         const Evidence& evidence) {
  Json json;
  json["version"] = SANDRUNNER_VERSION;
  json["runs"] = options.lab.runs;
  json["grid_runs"] = options.lab.grid_runs;
  for (const Model& model : models) {
    json["models"][model_name(model)] = {{"hash", fmt::format("{:016x}", model.hash)},
                                         {"provenance", model.network.spec.provenance}};
  }
  for (const auto& [experiment, controllers] : evidence.measured) {
    for (const auto& [controller, seeds] : controllers) {
      for (const auto& [seed, measured] : seeds) {
        json["experiments"][experiment][controller][std::to_string(seed)] = to_json(measured);
      }
    }
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sandrunner::study
