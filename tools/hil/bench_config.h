// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/run/process_config.h"

namespace sandrunner::hil {

/// The controller's configuration, read as it reads it: the same files and assignments go to both.
/// The policy is the one that ships. Throws InputError.
ProcessConfig read_bench_config(const std::string& hardware_path, const std::string& terrain,
                                const std::vector<std::string>& config_files,
                                const std::vector<std::string>& assignments);

}  // namespace sandrunner::hil
