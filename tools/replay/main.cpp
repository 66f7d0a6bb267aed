// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-replay: feeds the inputs of a recording through the controller and the policy again
// and compares every output bit by bit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "policy/policy_file.h"
#include "rt/base/build.h"
#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "rt/core/processor.h"
#include "rt/loop/replay.h"
#include "rt/report/run_observer.h"
#include "rt/run/process_config.h"
#include "rt/run/run_files.h"
#include "rt/run/scene.h"
#include "rt/run/signals.h"
#include "rt/telemetry/recording/recording_file.h"
#include "rt/telemetry/view/view_feed.h"
#include "rt/telemetry/view/view_server.h"
#include "sim/robot/robot_model.h"

namespace sandrunner {
namespace {

struct Arguments {
  std::string file, plot_dir;
  bool view = false;
  std::vector<std::string> assignments;
  double from_s = 0.0, to_s = std::numeric_limits<double>::infinity();
};

std::optional<Arguments> parse(int argc, char** argv) {
  Arguments a;
  CLI::App app(
      "Replays a recording: computes every control and policy step again from the recorded inputs "
      "and compares the outputs bit by bit. Exit code 0: all agree; 1: the first difference is "
      "printed, or there was nothing to compare; 2: the recording is damaged, cut or lacks ticks "
      "(what can be compared is compared all the same).",
      "sandrunner-replay");
  app.add_option("FILE", a.file, "recording (run.mcap, black-box-TICK.mcap)")->required();
  app.add_option("--from", a.from_s, "first second to compare and draw")->type_name("S");
  app.add_option("--to", a.to_s, "last second")->type_name("S");
  app.add_option("--plot", a.plot_dir, "folder for run.csv, run.html")->type_name("DIR");
  app.add_flag("--view", a.view,
               "shows the recording, of a long one the last 10 minutes, in a browser of this "
               "computer, at the address that is printed, until Ctrl-C");
  app.add_option("--set", a.assignments, "replay with a changed setting; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  app.footer(
      "Examples:\n"
      "  sandrunner-replay results/run.mcap\n"
      "  sandrunner-replay results/run.mcap --plot plots --from 2 --to 6\n"
      "  sandrunner-replay results/run.mcap --view\n"
      "  sandrunner-replay results/run.mcap --set controller.walk.kp_nmprad=40");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  if (!(a.from_s >= 0.0) || !(a.to_s > a.from_s)) {
    throw InputError(fmt::format("--from {} --to {}: expected 0 <= from < to", a.from_s, a.to_s));
  }
  return a;
}

// The robot of the recording itself, whatever files of its name there may be.
sim::Robot recorded_robot(const RecordingInfo& info, const std::string& file) {
  const auto require = [&](const std::string& data, const char* attachment) {
    if (!data.empty()) return;
    throw InputError(
        fmt::format("{}: has no attachment '{}', so its robot is not known: the file is cut, or no "
                    "recording of sandrunner",
                    file, attachment));
  };
  require(info.robot_map, kRobotMapAttachment);
  require(info.robot.urdf, kRobotAttachment);
  return sim::parse_robot(info.robot_map, fmt::format("{}: {}", file, kRobotMapAttachment),
                          info.robot.urdf, fmt::format("{}: {}", file, kRobotAttachment));
}

// Everything that needs the recorded settings before the first tick.
struct Player {
  Player(const RecordingInfo& info, const Arguments& arguments) {
    ConfigTree tree;
    tree.add_text(info.config, "the recording's settings");
    const std::string robot_name = tree.text("robot", "");
    for (const std::string& assignment : arguments.assignments) tree.set(assignment);
    PolicyRunner policy;
    if (!info.policy.empty()) {
      policy = PolicyRunner(load_policy_text(info.policy, "the recorded policy"));
    }
    const sim::Robot robot = recorded_robot(info, arguments.file);
    const bool another = tree.text("robot", "") != robot_name;  // by --set
    config = another ? read_process_config(tree, policy.spec())
                     : read_process_config(tree, policy.spec(), &robot, Ranges::kRecorded);
    if (info.first_tick == 0 || !info.state.empty()) {
      replay.emplace(config.controller, start_mode_of(info), policy);
      if (info.first_tick > 0) {
        replay->restore(read_replay_state(
            info.state, fmt::format("{}: attachment '{}'", arguments.file, kStateAttachment)));
      }
    }
    if (arguments.plot_dir.empty() && !arguments.view) return;
    const RunScene scene = scene_of(config, policy.name());
    if (arguments.view) {
      constexpr std::size_t kMostFrames = 10 * 60 * kPolicyHz;
      feed.emplace(scene,
                   ViewFeed::Limits{.frames = kMostFrames, .footprints = 16'384, .tiles = 2048});
    }
    observer.emplace(scene, feed ? std::vector<RowSink*>{&*feed} : std::vector<RowSink*>());
  }

  ProcessConfig config;
  std::optional<Replay> replay;         ///< nothing: the recording has no state to start from
  bool in_step = true;                  ///< false: behind lost ticks, until the next state
  std::optional<ViewFeed> feed;         ///< with --view
  std::optional<RunObserver> observer;  ///< with --plot or --view
};

std::string seconds(std::uint64_t tick) {
  return fmt::format("{:.5f} s", static_cast<double>(tick) * kControlPeriod_s);
}

// Until Ctrl-C.
void serve(Player& player) {
  SignalWatch signals;
  player.observer->end();
  player.feed->end();
  const ViewServer server(player.config.view_port, {.feed = *player.feed, .recorded = true});
  signals.run_begins();
  to_standard_error(fmt::format("sandrunner-replay: look at {}\n", server.url()));
  while (signals.interrupts() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

struct Compared {
  std::optional<ReplayDifference> difference;
  std::uint64_t ticks = 0, not_compared = 0, last_tick = 0;
};

// What each part of a recording does to the player and to what was compared so far.
RecordingVisitor visitor_of(const Arguments& arguments, std::optional<Player>& player,
                            Compared& compared) {
  RecordingVisitor visitor;
  visitor.begin = [&](const RecordingInfo& info) {
    player.emplace(info, arguments);
    if (info.build != build_name()) {
      to_standard_error(
          fmt::format("sandrunner-replay: warning: recorded by build {}, this is {}\n", info.build,
                      build_name()));
    }
  };
  visitor.tick = [&](const TickRecord& recorded) {
    compared.last_tick = recorded.input.sensors.tick;
    const double t_s = static_cast<double>(compared.last_tick) * kControlPeriod_s;
    if (t_s > arguments.to_s) return false;
    const bool compares = player->replay && player->in_step;
    std::optional<ReplayDifference> found;
    if (compares) found = player->replay->check(recorded);
    if (t_s < arguments.from_s) return true;
    ++(compares ? compared.ticks : compared.not_compared);
    if (player->observer) player->observer->add(recorded);
    if (player->feed) player->feed->add(recorded);
    if (found && !compared.difference) compared.difference = std::move(found);
    // A page wants the rest too.
    return (!compared.difference && player->replay) || player->observer;
  };
  visitor.lost = [&](std::uint64_t first, std::optional<std::uint64_t> last, bool by_damage) {
    player->in_step = false;
    fmt::print("LOST {}: tick {} ({}) to {}\n", by_damage ? "by damage" : "while recording", first,
               seconds(first), last ? fmt::format("{} ({})", *last, seconds(*last)) : "the end");
  };
  visitor.state = [&](const ReplayState& state) {
    if (player->in_step || !player->replay) return;
    player->replay->restore(state);
    player->in_step = true;
  };
  visitor.event = [](std::uint64_t tick, const std::string& kind, const std::string& text) {
    // What came from outside: the rest follows from the ticks.
    if (kind != "push" && kind != "terrain" && kind != "hand") return;
    fmt::print("before tick {} ({}): {}: {}\n", tick, seconds(tick), kind, one_line(text));
  };
  return visitor;
}

// What a recording lacks; empty: nothing.
std::string lacking(const RecordingContents& contents, const std::string& file) {
  if (!contents.damage.empty()) return contents.damage;
  if (!contents.complete) {
    return fmt::format("{}: the recording was cut, it is read up to its last chunk", file);
  }
  if (contents.lost == 0) return {};
  // Which of them were slots that the loop skipped stood in the lost ones.
  return fmt::format("{}: up to {} ticks were lost while recording, they are not compared", file,
                     contents.lost);
}

// Compares, and draws what is asked for; returns the exit code.
int replay(const Arguments& arguments, std::optional<Player>& player) {
  Compared compared;
  const RecordingContents contents =
      read_recording(arguments.file, visitor_of(arguments, player, compared));

  if (player->observer) {
    const RunRecord record = player->observer->take_record();
    if (!arguments.plot_dir.empty() && compared.ticks + compared.not_compared > 0) {
      prepare_folder(arguments.plot_dir, "--plot");
      fmt::print("wrote {}\n", write_run_files(record, arguments.plot_dir));
    }
  }
  const std::string lacks = lacking(contents, arguments.file);
  if (!player->replay) {
    throw InputError(fmt::format(
        "{}: begins at tick {} without the state of controller and network there, because ticks "
        "before it were lost: it cannot be replayed",
        arguments.file, contents.info.first_tick));
  }
  if (const auto& difference = compared.difference) {
    fmt::print("DIFFERS at tick {} ({}): {}\n", difference->tick, seconds(difference->tick),
               difference->what);
    return kExitFailed;
  }
  if (compared.ticks == 0) {
    fmt::print("NOTHING COMPARED: the recording has {}\n",
               contents.ticks == 0 ? "no ticks"
                                   : fmt::format("none to compare in this range, it ends at {}",
                                                 seconds(compared.last_tick)));
    if (lacks.empty()) return kExitFailed;
  } else {
    fmt::print("{} ticks and {} policy steps compared: every bit agrees\n", compared.ticks,
               player->replay->policy_steps());
  }
  if (compared.not_compared > 0) {
    fmt::print("{} ticks behind lost ones have no state to start from: NOT COMPARED\n",
               compared.not_compared);
  }
  if (!lacks.empty()) throw InputError(lacks);
  return kExitOk;
}

int run(int argc, char** argv) {
  const std::optional<Arguments> arguments = parse(argc, argv);
  if (!arguments) return kExitOk;
  flush_denormals_to_zero();
  std::optional<Player> player;
  int code = kExitOk;
  std::exception_ptr amiss;  // what is whole can be looked at all the same
  try {
    code = replay(*arguments, player);
  } catch (const InputError&) {
    amiss = std::current_exception();
  }
  if (player && player->feed) {
    std::fflush(stdout);
    serve(*player);
  }
  if (amiss) std::rethrow_exception(amiss);
  return code;
}

}  // namespace
}  // namespace sandrunner

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-replay", [&] { return sandrunner::run(argc, argv); });
}
