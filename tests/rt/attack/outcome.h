// SPDX-License-Identifier: BSD-3-Clause
// Which rows of a campaign run.
#pragma once

#include <cstdlib>
#include <string>

#include "attack_loop.h"
#include "tests/rt/loop/watch.h"

namespace sandrunner::attack {

/// Whether a campaign is to run the row `name`: all, or those that contain SANDRUNNER_ATTACK_ONLY.
inline bool is_selected(const std::string& name) {
  const char* const only = std::getenv("SANDRUNNER_ATTACK_ONLY");
  return only == nullptr || name.find(only) != std::string::npos;
}

}  // namespace sandrunner::attack
