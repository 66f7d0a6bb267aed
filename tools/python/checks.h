// SPDX-License-Identifier: BSD-3-Clause
// What several parts of the module check of their arguments.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "sim/ground/terrain_description.h"

namespace sandrunner::python {

inline constexpr int kMostThreads = 256, kMostRobots = 1 << 20;

/// The number, if it is in this range; else throws InputError.
template <typename Number>
Number checked(const char* name, Number found, Number least, Number most) {
  if (found >= least && found <= most) return found;
  throw InputError(fmt::format("{}: found {}, expected {} to {}", name, found, least, most));
}

/// `ground`: a preset or terrain file; `settings`: PATH=VALUE of its table. Throws InputError.
inline sim::TerrainDescription read_ground(const std::string& ground,
                                           const std::vector<std::string>& settings) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, ground, "ground");
  for (const std::string& setting : settings) tree.set(setting, "settings");
  sim::TerrainDescription description = sim::read_terrain(tree);
  tree.reject_unknown();
  return description;
}

/// Remembers the process in which an object has made its threads.
class OwnProcess {
 public:
  /// Throws InputError in a fork of it, in which the threads don't live on. `what`: of Python.
  void require(const char* what) const {
    if (getpid() == process_) return;
    throw InputError(
        fmt::format("{}: found a process that was forked after this was made, expected the one "
                    "that made it: its threads do not live on in a fork",
                    what));
  }

 private:
  pid_t process_ = getpid();
};

}  // namespace sandrunner::python
