// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/bench_config.h"

#include <fmt/format.h>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "sim/ground/terrain_description.h"

namespace sandrunner::hil {

ProcessConfig read_bench_config(const std::string& hardware_path, const std::string& terrain,
                                const std::vector<std::string>& config_files,
                                const std::vector<std::string>& assignments) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, terrain);
  tree.add_file(hardware_path);
  for (const std::string& file : config_files) tree.add_file(file);
  for (const std::string& assignment : assignments) tree.set(assignment);
  const std::string shipped = shipped_policy_for(tree);
  const Policy policy = load_shipped_policy(shipped);
  // Another robot only stands here: the gains of its policy are not known.
  const bool own = tree.text("robot", "raibo") == shipped;
  ProcessConfig config = read_process_config(tree, own ? &policy.spec() : nullptr);
  if (!config.driver) {
    throw InputError(fmt::format("{}: found no table [hardware]", hardware_path));
  }
  return config;
}

}  // namespace sandrunner::hil
