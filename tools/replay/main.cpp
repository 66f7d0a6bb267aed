// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-replay: feeds the inputs of a recording through the controller and the policy again
// and compares every output bit by bit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "policy/policy_file.h"
#include "rt/base/build.h"
#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "rt/core/floating_point.h"
#include "rt/loop/replay.h"
#include "rt/report/run_csv.h"
#include "rt/report/run_observer.h"
#include "rt/report/run_pictures.h"
#include "rt/run/process_config.h"
#include "rt/run/scene.h"
#include "rt/telemetry/recording/recording_file.h"

namespace sandrunner {
namespace {

struct Arguments {
  std::string file, plot_dir;
  std::vector<std::string> assignments;
  double from_s = 0.0, to_s = std::numeric_limits<double>::infinity();
};

std::optional<Arguments> parse(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Replays a recording: computes every control and policy step again from the recorded inputs "
      "and compares the outputs bit by bit. Exit code 0: all agree; 1: the first difference is "
      "printed.",
      "sandrunner-replay");
  app.add_option("FILE", a.file, "recording (run.mcap, black-box-TICK.mcap)")->required();
  app.add_option("--from", a.from_s, "first second that is compared and drawn")->type_name("S");
  app.add_option("--to", a.to_s, "last second")->type_name("S");
  app.add_option("--plot", a.plot_dir, "folder for run.csv, run.png, strip.png")->type_name("DIR");
  app.add_option("--set", a.assignments, "what if: one setting otherwise; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  app.footer(
      "Examples:\n"
      "  sandrunner-replay results/run.mcap\n"
      "  sandrunner-replay results/run.mcap --plot plots --from 2 --to 6\n"
      "  sandrunner-replay results/run.mcap --set controller.walk.kp_nmprad=40");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  if (!(a.from_s >= 0.0) || !(a.to_s > a.from_s)) {
    throw InputError(fmt::format("--from {} --to {}: expected 0 <= from < to", a.from_s, a.to_s));
  }
  return a;
}

// Everything that needs the recorded settings before the first tick.
struct Player {
  Player(const RecordingInfo& info, const Arguments& arguments) {
    ConfigTree tree;
    tree.add_text(info.config, "the recording's settings");
    for (const std::string& assignment : arguments.assignments) tree.set(assignment);
    if (!info.policy.empty()) policy.emplace(load_policy_text(info.policy, "the recorded policy"));
    config = read_process_config(tree, policy ? &policy->spec() : nullptr);
    if (info.first_tick == 0 || !info.state.empty()) {
      replay.emplace(config.controller, start_mode_of(info), policy ? &*policy : nullptr);
      if (info.first_tick > 0) {
        replay->restore(read_replay_state(
            info.state, fmt::format("{}: attachment '{}'", arguments.file, kStateAttachment)));
      }
    }
    if (arguments.plot_dir.empty()) return;
    observer = std::make_unique<RunObserver>(scene_of(config, policy ? policy->spec().name : ""),
                                             true, std::function<void(const RunSample&)>());
  }

  ProcessConfig config;
  std::optional<Policy> policy;
  std::optional<Replay> replay;  ///< nothing: the recording has no state to start from
  std::unique_ptr<RunObserver> observer;
};

int run(int argc, char** argv) {
  const std::optional<Arguments> arguments = parse(argc, argv);
  if (!arguments) return kExitOk;
  flush_denormals_to_zero();
  std::optional<Player> player;
  std::optional<ReplayDifference> difference;
  std::uint64_t compared = 0;
  const auto begin = [&](const RecordingInfo& info) {
    player.emplace(info, *arguments);
    if (info.build != build_name()) {
      to_standard_error(
          fmt::format("sandrunner-replay: warning: recorded by build {}, this is {}\n", info.build,
                      build_name()));
    }
  };
  const auto tick = [&](const TickRecord& recorded) {
    const double t_s = static_cast<double>(recorded.input.sensors.tick) * kControlPeriod_s;
    if (t_s > arguments->to_s) return false;
    std::optional<ReplayDifference> found;
    if (player->replay) found = player->replay->check(recorded);
    if (t_s < arguments->from_s) return true;
    ++compared;
    if (player->observer) player->observer->add(recorded);
    if (found && !difference) difference = std::move(found);
    // A picture wants the rest too.
    return (!difference && player->replay) || player->observer;
  };
  const RecordingContents contents = read_recording(arguments->file, begin, tick);

  if (player && player->observer) {
    const RunRecord record = player->observer->take_record();
    const std::string dir = arguments->plot_dir + "/";
    prepare_folder(arguments->plot_dir, "--plot");
    write_csv(record, dir + "run.csv");
    draw_run_plot(record, dir + "run.png");
    if (record.has_truth()) draw_run_strip(record, dir + "strip.png");
    fmt::print("wrote {0}run.csv, {0}run.png{1}\n", dir,
               record.has_truth() ? fmt::format(", {}strip.png", dir) : "");
  }
  if (!contents.complete) fmt::print("the recording was cut: it is read up to its last chunk\n");
  if (player && !player->replay) {
    throw InputError(fmt::format(
        "{}: begins at tick {} without the state of controller and network there, because ticks "
        "before it were lost: it cannot be replayed",
        arguments->file, contents.info.first_tick));
  }
  if (difference) {
    fmt::print("DIFFERS at tick {} ({:.5f} s): {}\n", difference->tick,
               static_cast<double>(difference->tick) * kControlPeriod_s, difference->what);
    return kExitRobotFailed;
  }
  fmt::print("{} ticks and {} policy steps compared: every bit agrees\n", compared,
             player ? player->replay->policy_steps() : 0);
  return kExitOk;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-replay", [&] { return sandrunner::run(argc, argv); });
}
