// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/recording.h"

#include <fmt/format.h>

#include <utility>

#include "rt/base/build.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"

namespace sandrunner {
namespace {

RecordingInfo info_of(const Options& options, const ProcessConfig& config,
                      std::string_view policy) {
  RecordingInfo info;
  info.build = build_name();
  info.start_mode = options.start_walking ? "walk" : "passive";
  info.clock = clock_name(options.clock);
  info.config = config.effective;
  info.policy = policy;
  info.robot_map = config.robot.map;
  info.robot = config.robot.description;
  return info;
}

std::string recording_line(const RecordingResult& r, std::uint64_t dropped,
                           const std::string& path) {
  if (r.ticks == 0 && r.stopped_because.empty()) return "recorded nothing: no tick ran\n";
  if (r.removed) return fmt::format("NOT RECORDED: {} was removed during the run\n", path);
  const std::string lost =
      dropped > 0
          ? fmt::format("; {} ticks LOST, a replay compares nothing behind the first of them",
                        dropped)
          : "";
  return fmt::format("recorded {} ticks, {:.1f} MB, in {}{}{}\n", r.ticks,
                     1e-6 * static_cast<double>(r.bytes), path, lost,
                     r.stopped_because.empty() ? "" : "; STOPPED: " + r.stopped_because);
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
  if (!r.stopped_because.empty()) {
    lines += fmt::format("black box: STOPPED: {}\n", r.stopped_because);
  }
  return lines;
}

// Of the way to the black box; that of the recording is in its own line.
std::string replay_lines(const ReplayedResult& r) {
  std::string lines;
  if (r.dropped > 0) {
    lines += fmt::format(
        "black box: {} ticks LOST{}\n", r.dropped,
        r.lost_from ? fmt::format("; from tick {} on the run is not verified", *r.lost_from) : "");
  }
  if (r.difference) {
    lines += fmt::format("black box: the run DIFFERS from its replay at tick {}: {}\n",
                         r.difference->tick, r.difference->what);
  }
  return lines;
}

std::string black_box_folder(const Options& options) {
  return !options.record_dir.empty() ? options.record_dir
         : !options.out_dir.empty()  ? options.out_dir
                                     : ".";
}

}  // namespace

RunRecording::RunRecording(const Options& options, const ProcessConfig& config,
                           std::string_view policy_file, const PolicyRunner& policy)
    : path_(options.record_dir + "/run.mcap") {
  const RecordingInfo info = info_of(options, config, policy_file);
  std::vector<TickKeeper*> keepers;
  if (!options.record_dir.empty()) {
    prepare_folder(options.record_dir, "--record");
    keepers.push_back(&recorder_.emplace(path_, info, config.recording));
  }
  if (options.clock == RunClock::kRealtime) {
    keepers.push_back(&black_box_.emplace(black_box_folder(options), info));
  }
  if (keepers.empty()) return;
  ticks_.emplace(config.controller, start_mode_of(info), policy,
                 options.clock == RunClock::kRealtime ? WhenFull::kDrop : WhenFull::kWait,
                 std::move(keepers));
}

void RunRecording::add_to(std::vector<TickSink*>& sinks) {
  if (ticks_) sinks.push_back(&*ticks_);
}

std::string RunRecording::report(std::uint64_t never_seen) const {
  std::string lines;
  if (!ticks_) return lines;
  ReplayedResult replayed = ticks_->result();
  replayed.dropped += never_seen;
  if (recorder_) lines += recording_line(recorder_->result(), replayed.dropped, path_);
  if (black_box_) lines += black_box_lines(black_box_->result()) + replay_lines(replayed);
  return lines;
}

void RunRecording::require_whole() const {
  if (!recorder_) return;
  const RecordingResult& recorded = recorder_->result();
  if (recorded.removed) {
    throw InputError(fmt::format("--record: {} was removed during the run", path_));
  }
  if (recorded.failed) {
    throw InputError(fmt::format("--record: the recording is cut: {}", recorded.stopped_because));
  }
}

}  // namespace sandrunner
