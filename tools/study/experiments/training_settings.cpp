// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/training_settings.h"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
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

double training_length(const Model& model) {
  return std::strtod(setting_of(model, "run.transitions").c_str(), nullptr);
}

}  // namespace sandrunner::study
