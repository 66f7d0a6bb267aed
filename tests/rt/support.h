// SPDX-License-Identifier: BSD-3-Clause
// What several tests of the program need: settings, policies, a check of refusals.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

#include "core/printing.h"
#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/run/process_config.h"
#include "rt/run/run.h"
#include "tests/policy/random_policy.h"

namespace sandrunner {

/// Settings as the program makes them from --terrain and --set.
inline ProcessConfig config_of(const std::string& terrain,
                               const std::vector<std::string>& assignments = {},
                               const PolicySpec* spec = nullptr) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, terrain);
  for (const std::string& assignment : assignments) tree.set(assignment);
  return read_process_config(tree, spec);
}

/// A policy that runs, not one that walks.
inline Policy random_policy(std::uint64_t seed = 1) {
  const PolicyFile file = random_policy_file(seed);
  return {file.spec, Network(file.parameters)};
}

/// `run_lockstep` under "1,0,0", uninterrupted.
inline RunResult run_once(const ProcessConfig& config, Policy* policy, const RunPlan& plan,
                          bool keep_record = false) {
  const std::atomic<bool> interrupt{false};
  return run_lockstep(config, policy, CommandSource("1,0,0"), plan, keep_record, interrupt, {});
}

/// Checks that `action` is refused in one line that has all of `parts`.
template <typename Action>
void expect_refused(const Action& action, const std::vector<std::string>& parts) {
  try {
    action();
    ADD_FAILURE() << "not refused; expected an error with '" << parts.front() << "'";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    for (const std::string& part : parts) {
      EXPECT_NE(what.find(part), std::string::npos) << "no '" << part << "' in: " << what;
    }
  }
}

}  // namespace sandrunner
