// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rt/run/options.h"
#include "rt/run/process_config.h"
#include "rt/telemetry/recording/black_box.h"
#include "rt/telemetry/recording/recorder.h"

namespace sandrunner {

/// The files of a run's ticks: the recording of `--record`, and the black box of a real-time run (a
/// run in lockstep can be repeated). The files of the black box go to the folder of `--record`,
/// else of `--out`, else to the working folder.
class RunRecording {
 public:
  /// `policy_file` is the file of `policy`, whole; empty: there is none. Throws InputError if the
  /// file of `--record` cannot be made.
  RunRecording(const Options& options, const ProcessConfig& config, std::string_view policy_file,
               const PolicyRunner& policy);

  /// Adds itself, if there is anything to keep.
  void add_to(std::vector<TickSink*>& sinks);

  // After the run:
  /// A line for each file and for all that went wrong; `never_seen`: ticks that came to no sink.
  std::string report(std::uint64_t never_seen) const;
  /// Throws InputError if the recording is not there or was cut by the disk.
  void require_whole() const;

 private:
  const std::string path_;  // of --record
  std::optional<Recorder> recorder_;
  std::optional<BlackBox> black_box_;
  std::optional<ReplayedTicks> ticks_;  // the others outlive its thread
};

}  // namespace sandrunner
