// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/hil/bench.h"
#include "tools/hil/bench_config.h"

namespace sandrunner::hil {

/// What the bench reads of an example: "damiao", "mit", "moteus", or "unitree".
inline ProcessConfig bench_example(const std::string& name) {
  const std::string path = name == "unitree" ? SANDRUNNER_UNITREE_EXAMPLE
                                             : SANDRUNNER_HARDWARE_EXAMPLES "/" + name + ".toml";
  return read_bench_config(path, "dry-sand", {}, {});
}

}  // namespace sandrunner::hil
