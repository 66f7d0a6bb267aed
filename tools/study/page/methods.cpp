// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/page/methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <map>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "tools/study/page/html.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

// Asks for a setting, of the type that this value of it has. Throws InputError if it has another.
void ask(const std::string& key, const std::string& value, ConfigTree& settings) {
  constexpr double kAny = std::numeric_limits<double>::max();
  if (value.starts_with('"')) {
    settings.text(key, "");
  } else if (value == "true" || value == "false") {
    settings.flag(key, false);
  } else if (value.starts_with('[')) {
    settings.numbers(key, {}, ConfigTree::kAnySize, -kAny, kAny);
  } else {
    settings.number(key, 0.0, -kAny, kAny);
  }
}

// A path without its folders, which are those of the machine that trained.
std::string without_folders(const std::string& value) {
  const std::size_t slash = value.rfind('/');
  return slash == std::string::npos ? value : fmt::format("\"{}", value.substr(slash + 1));
}

// A setting in the provenance of a model; empty if it is not there.
std::string setting_of(const Model& model, const std::string& key) {
  const auto config = model.network.spec.provenance.find("config");
  if (config == model.network.spec.provenance.end()) return "";
  const auto settings = settings_in(config->second);
  const auto found = settings.find(key);
  return found == settings.end() ? "" : found->second;
}

double length_of(const Model& model) {
  return std::strtod(setting_of(model, "run.transitions").c_str(), nullptr);
}

std::string origin_table(const std::vector<Model>& models) {
  constexpr const char* kKeys[] = {"seed",      "transitions", "core_hours",
                                   "processor", "commit",      "origin"};
  HtmlTable table{
      {"model", "length of the training, million transitions", "seed", "taken after transitions",
       "core-hours until then", "processor", "commit", "origin", "hash of the file"},
      {}};
  for (const Model& model : models) {
    const auto& provenance = model.network.spec.provenance;
    std::vector<std::string> row = {model_name(model),
                                    fmt::format("{:.4g}", 1e-6 * length_of(model))};
    for (const char* key : kKeys) {
      const auto found = provenance.find(key);
      row.push_back(found == provenance.end() ? "" : escaped(found->second));
    }
    row.push_back(fmt::format("{:016x}", model.hash));
    table.rows.push_back(row);
  }
  return table.html();
}

}  // namespace

std::vector<SettingDifference> settings_that_differ(const std::string& config,
                                                    const sim::Robot& robot) {
  ConfigTree theirs, usual;
  theirs.add_text(config, "provenance.config");
  train::add_training_layers(usual, robot);
  for (const auto& [key, value] : settings_in(config)) {
    ask(key, value, theirs);
    if (!usual.has(key)) continue;
    try {
      ask(key, value, usual);
    } catch (const InputError&) {
      // An older trainer's: here something else, such as a table, has this name.
    }
  }
  const auto usual_values = settings_in(usual.effective());
  std::vector<SettingDifference> differences;
  for (const auto& [key, value] : settings_in(theirs.effective())) {
    const auto found = usual_values.find(key);
    const std::string usual_value = found == usual_values.end() ? "" : found->second;
    if (key == "run.transitions" || value == usual_value) continue;
    differences.push_back({key, without_folders(value), usual_value});
  }
  return differences;
}

double longest_training(const std::vector<Model>& models) {
  double longest = 0.0;
  for (const Model& model : models) longest = std::max(longest, length_of(model));
  return longest;
}

std::string methods_tables(const std::vector<Model>& models, const sim::Robot& robot) {
  HtmlTable settings{{"controller", "setting", "value", "usual value", "seeds"}, {}};
  // By controller, then setting and value: the seeds that have it.
  for (std::size_t begin = 0; begin < models.size();) {
    const Controller& controller = *models[begin].controller;
    std::map<std::array<std::string, 3>, std::vector<int>> seeds;
    std::vector<int> all;
    for (; begin < models.size() && models[begin].controller == &controller; ++begin) {
      const auto& provenance = models[begin].network.spec.provenance;
      const auto config = provenance.find("config");
      if (config == provenance.end()) continue;
      all.push_back(models[begin].seed);
      for (const SettingDifference& d : settings_that_differ(config->second, robot)) {
        seeds[{d.key, d.value, d.usual}].push_back(models[begin].seed);
      }
    }
    for (const auto& [setting, of_seeds] : seeds) {
      settings.rows.push_back({controller.name, escaped(setting[0]), escaped(setting[1]),
                               setting[2].empty() ? "no such setting" : escaped(setting[2]),
                               fmt::format("{}", fmt::join(of_seeds, ", "))});
    }
    if (seeds.empty() && !all.empty()) {
      settings.rows.push_back(
          {controller.name, "none", "", "", fmt::format("{}", fmt::join(all, ", "))});
    }
  }
  return origin_table(models) + settings.html();
}

}  // namespace sandrunner::study
