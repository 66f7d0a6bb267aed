// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "rt/run/options.h"
#include "rt/run/process_config.h"
#include "rt/telemetry/recording/black_box.h"
#include "rt/telemetry/recording/recorder.h"

namespace sandrunner {

/// The recorder of `--record`; null without it. `policy_file` is the file of `policy`, whole;
/// empty: there is none. Throws InputError if the file cannot be made.
std::unique_ptr<Recorder> make_recorder(const Options& options, const ProcessConfig& config,
                                        std::string_view policy_file, const PolicyRunner& policy);

/// The black box of a real-time run; null in lockstep, where the run can be had again. Its files go
/// to the folder of `--record`, else of `--out`, else to the working folder.
std::unique_ptr<BlackBox> make_black_box(const Options& options, const ProcessConfig& config,
                                         std::string_view policy_file, const PolicyRunner& policy);

/// What it did, a line for each file and for all that went wrong; empty: there was no fault.
std::string black_box_lines(const BlackBoxResult& result);

}  // namespace sandrunner
