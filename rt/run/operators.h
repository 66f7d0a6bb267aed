// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "rt/operator/operator_desk.h"
#include "rt/operator/remote_operator.h"
#include "rt/operator/return_to_stand.h"
#include "rt/run/command_source.h"
#include "rt/run/options.h"
#include "rt/run/process_config.h"
#include "rt/run/run_script.h"

namespace sandrunner {

/// Who commands the robot of a run: people at a desk (--command dds or live), else a script.
class Operators {
 public:
  /// `command`: of the script; it must outlive this object.
  Operators(const Options& options, const ProcessConfig& config, const CommandSource& command,
            bool has_policy);

  OperatorInput& input() noexcept;
  /// Null: a script commands.
  OperatorDesk* desk() noexcept { return desk_ ? &*desk_ : nullptr; }
  /// Null: the robot is real, or a script commands.
  ReturnToStand* return_to_stand() noexcept {
    return return_to_stand_ ? &*return_to_stand_ : nullptr;
  }
  /// Enters what the script saw of the run.
  void report(RunResult& result) const;

 private:
  const char* const no_walk_;  // why the robot may not walk; null: it may
  RunScript script_;
  std::optional<RemoteOperator> remote_;
  std::optional<OperatorDesk> desk_;
  std::optional<ReturnToStand> return_to_stand_;
};

}  // namespace sandrunner
