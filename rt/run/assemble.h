// SPDX-License-Identifier: BSD-3-Clause
// From the command line to what a run is made of.
#pragma once

#include <string>

#include "rt/loop/policy_runner.h"
#include "rt/run/options.h"
#include "rt/run/process_config.h"

namespace sandrunner {

/// The settings of a run. `spec` may be null. `hardware`: text in place of the hardware file's own;
/// null: that. Throws InputError.
ProcessConfig read_config(const Options& options, const PolicySpec* spec,
                          const std::string* hardware = nullptr);

/// A policy and its file, whole; both empty for `--policy none`.
struct RunPolicy {
  std::string file;
  PolicyRunner runner;
};

/// Throws InputError.
RunPolicy load_run_policy(const Options& options);

/// What is unusual about the settings, on standard error.
void warn_of(const ProcessConfig& config, const PolicyRunner& policy);

}  // namespace sandrunner
