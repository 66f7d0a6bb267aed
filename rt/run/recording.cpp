// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/recording.h"

#include <fmt/format.h>

#include "rt/base/build.h"
#include "rt/base/output_files.h"

namespace sandrunner {
namespace {

RecordingInfo info_of(const Options& options, const ProcessConfig& config,
                      std::string_view policy) {
  RecordingInfo info;
  info.build = build_name();
  info.start_mode = options.start_walking ? "walk" : "passive";
  info.clock = options.realtime ? "realtime" : "lockstep";
  info.config = config.effective;
  info.policy = policy;
  info.robot_map = config.robot.map;
  info.robot = config.robot.description;
  return info;
}

}  // namespace

std::unique_ptr<Recorder> make_recorder(const Options& options, const ProcessConfig& config,
                                        std::string_view policy_file, const PolicyRunner& policy) {
  if (options.record_dir.empty()) return nullptr;
  prepare_folder(options.record_dir, "--record");
  return std::make_unique<Recorder>(options.record_dir + "/run.mcap",
                                    info_of(options, config, policy_file), config.recording,
                                    !options.realtime, &config.controller, policy);
}

std::unique_ptr<BlackBox> make_black_box(const Options& options, const ProcessConfig& config,
                                         std::string_view policy_file, const PolicyRunner& policy) {
  if (!options.realtime) return nullptr;
  const std::string folder = !options.record_dir.empty() ? options.record_dir
                             : !options.out_dir.empty()  ? options.out_dir
                                                         : ".";
  return std::make_unique<BlackBox>(folder, info_of(options, config, policy_file),
                                    config.controller, policy);
}

std::string black_box_lines(const BlackBoxResult& r) {
  std::string lines;
  for (const BlackBoxFile& file : r.files) {
    const std::string what = fmt::format("the {:.1f} s before the fault '{}' at {:.3f} s",
                                         file.before_s, fault_name(file.fault),
                                         static_cast<double>(file.fault_tick) * kControlPeriod_s);
    lines += file.problem.empty()
                 ? fmt::format("black box: {}, in {}{}\n", what, file.path,
                               file.has_start ? "" : "; it has no start state: NOT REPLAYABLE")
                 : fmt::format("black box: {}: NOT WRITTEN: {}\n", what, file.problem);
  }
  if (r.left_out > 0) {
    lines += fmt::format("black box: {} more faults have no file, a run has {}\n", r.left_out,
                         kBlackBoxFiles);
  }
  if (r.dropped > 0) {
    lines += fmt::format(
        "black box: {} ticks LOST{}\n", r.dropped,
        r.lost_from ? fmt::format("; from tick {} on the run is not verified", *r.lost_from) : "");
  }
  if (r.difference) {
    lines += fmt::format("black box: the run DIFFERS from its replay at tick {}: {}\n",
                         r.difference->tick, r.difference->what);
  }
  if (!r.stopped_because.empty()) {
    lines += fmt::format("black box: STOPPED: {}\n", r.stopped_because);
  }
  return lines;
}

}  // namespace sandrunner
