// SPDX-License-Identifier: BSD-3-Clause
#include "rt/recording.h"

#include <chrono>

#include "rt/build.h"
#include "rt/output_files.h"

namespace sandrunner {

std::unique_ptr<Recorder> make_recorder(const Options& options, const ProcessConfig& config,
                                        std::string_view policy) {
  if (options.record_dir.empty()) return nullptr;
  prepare_folder(options.record_dir, "--record");
  using std::chrono::system_clock, std::chrono::nanoseconds, std::chrono::duration_cast;
  const RecordingInfo info{
      .build = build_name(),
      .start_mode = options.start_walking ? "walk" : "passive",
      .clock = options.realtime ? "realtime" : "lockstep",
      .config = config.effective,
      .policy = std::string(policy),
      .robot = config.robot.description,
      .start_time_ns = duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count()};
  return std::make_unique<Recorder>(options.record_dir + "/run.mcap", info, config.recording,
                                    !options.realtime);
}

}  // namespace sandrunner
