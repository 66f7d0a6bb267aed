// SPDX-License-Identifier: BSD-3-Clause
// tools/train/REFERENCE.md states the settings as the program has them, and all of those of the
// task.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tools/train/task/robot_settings.h"
#include "tools/train/train_config.h"

namespace sandrunner::train {
namespace {

// The settings of a training of Raibo, one "path = value" a line, after these assignments.
std::string settings_after(const std::vector<std::string>& assignments) {
  static const sim::Robot raibo = sim::load_raibo();
  ConfigTree tree;
  add_training_layers(tree, raibo);
  for (const std::string& assignment : assignments) tree.set(assignment);
  return read_train_config(tree).effective;
}

// Every `path.key = value` in back quotes on the page, as "path.key=value".
std::vector<std::string> stated_settings() {
  std::vector<std::string> stated;
  std::ifstream page(SANDRUNNER_TRAINING_REFERENCE);
  for (std::string span; std::getline(page, span, '`');) {
    const auto equals = span.find(" = ");
    if (equals == std::string::npos || span.find('\n') != std::string::npos ||
        span.find('.') > equals) {
      continue;
    }
    stated.push_back(span.substr(0, equals) + "=" + span.substr(equals + 3));
  }
  return stated;
}

TEST(TrainingReferenceTest, StatesTheValuesThatTheProgramHas) {
  const std::string shipped = settings_after({});
  for (const std::string& setting : stated_settings()) {
    EXPECT_EQ(settings_after({setting}), shipped) << "tools/train/REFERENCE.md: " << setting;
  }
}

TEST(TrainingReferenceTest, StatesEverySettingOfTheTask) {
  std::set<std::string> stated;
  for (const std::string& setting : stated_settings()) {
    stated.insert(setting.substr(0, setting.find('=')));
  }
  const std::set<std::string> tables{"policy", "episode", "command", "ground", "robot", "noise"};
  std::istringstream shipped(settings_after({}));
  for (std::string line; std::getline(shipped, line);) {
    const std::string key = line.substr(0, line.find(" = "));
    if (!tables.contains(key.substr(0, key.find('.')))) continue;
    EXPECT_TRUE(stated.contains(key)) << "missing in tools/train/REFERENCE.md: " << key;
  }
}

}  // namespace
}  // namespace sandrunner::train
