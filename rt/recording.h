// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "rt/options.h"
#include "rt/process_config.h"
#include "rt/telemetry/recording/recorder.h"

namespace sandrunner {

/// The recorder of `--record`; null without it. `policy` is the policy file, whole. Throws
/// InputError if the file cannot be made.
std::unique_ptr<Recorder> make_recorder(const Options& options, const ProcessConfig& config,
                                        std::string_view policy);

}  // namespace sandrunner
