// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/unitree_check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "rt/base/standard_error.h"
#include "rt/base/typed_lines.h"

namespace sandrunner {
namespace {

constexpr double kAtStop_rad = 0.01;  // a robot that lies rests its knees on their stops
constexpr std::int64_t kPicture_ns = 100'000'000;
constexpr std::int64_t kReaderTime_ns = 1'000'000'000;
constexpr double kSwitcherTime_s = 1.0;

using unitree::RobotState;

/// Joints and battery as they are, one picture over the other, until the user types a line.
void show_live(unitree::RobotLink& link, const UnitreeConfig& config,
               const unitree::RobotFigures& robot) {
  Lines lines;
  std::size_t drawn_lines = 0;
  while (!lines.next() && !lines.ended()) {
    const std::int64_t end_ns = clock_ns(CLOCK_MONOTONIC) + kPicture_ns;
    while (clock_ns(CLOCK_MONOTONIC) < end_ns) link.wait(end_ns);
    const std::string picture = unitree_state_table(config, robot, link.states().state()) +
                                "live until Enter; nothing is powered\n";
    const std::string back = drawn_lines > 0 ? fmt::format("\x1b[{}A\x1b[J", drawn_lines) : "\n";
    to_standard_error(back + picture);
    drawn_lines = static_cast<std::size_t>(std::ranges::count(picture, '\n'));
  }
}

std::string crc_words(const unitree::StateCounters& c) {
  if (c.bad_crc > 0) return fmt::format("{} of {} with a WRONG CRC", c.bad_crc, c.received());
  return c.without_crc > 0 ? "no CRC" : "CRC good";
}

std::string mode_words(const UnitreeFindings& findings) {
  if (!findings.mode) return "unknown: its service motion_switcher does not answer";
  if (findings.mode->empty()) return "off";
  return fmt::format("'{}' is on; a run switches it off while the robot lies", *findings.mode);
}

}  // namespace

std::vector<std::string> unitree_check_problems(const UnitreeConfig& config,
                                                const unitree::RobotFigures& robot,
                                                const UnitreeFindings& f) {
  std::vector<std::string> problems =
      unitree::state_problems(config, robot, f.states, f.wrong_state_type);
  if (!f.commands_are_read) {
    problems.push_back(
        fmt::format("{}: found {}, expected the robot", unitree::kCommandTopic,
                    f.wrong_command_type ? "a reader of another type" : "no reader of commands"));
  }
  // While sport mode is on, it commands the robot itself.
  if (f.foreign_commands > 0 && f.mode && f.mode->empty()) {
    problems.push_back(fmt::format("{}: found {} commands of another program, expected none",
                                   unitree::kCommandTopic, f.foreign_commands));
  }
  if (!f.mode && config.release_sport_mode) {
    problems.emplace_back(
        "motion_switcher: found no answer, expected firmware 1.0.24 or later; if sport "
        "mode is off already: hardware.unitree.release_sport_mode=false");
  }
  return problems;
}

std::string unitree_state_table(const UnitreeConfig& config, const unitree::RobotFigures& robot,
                                const RobotState& state) {
  std::string text = fmt::format("{:<16}{:>5}{:>10}{:>18}{:>7}{:>6}{:>6}\n", "joint", "motor",
                                 "rad", "stops, rad", "degC", "mode", "lost");
  for (int j = 0; j < kNumJoints; ++j) {
    const double q = state.position_rad[j];
    const bool past = q < robot.lower_rad[j] - kAtStop_rad || q > robot.upper_rad[j] + kAtStop_rad;
    text += fmt::format("{:<16}{:>5}{:>10.3f}{:>9.3f}{:>9.3f}{:>7}{:>6}{:>6}{}{}\n",
                        robot.joint_names[j], unitree::motor_of(j), q, robot.lower_rad[j],
                        robot.upper_rad[j], state.temperature_degc[j], state.mode[j], state.lost[j],
                        past ? "  past its stop" : "",
                        state.temperature_degc[j] > config.temperature_limit_degc ? "  hot" : "");
  }
  return text + fmt::format("battery {} %, {:.1f} V, {:.1f} A; remote {}\n", state.battery_percent,
                            state.supply_v, state.supply_a,
                            !state.remote.on    ? "off"
                            : state.remote.stop ? "on, L2 and B PRESSED"
                                                : "on");
}

std::string unitree_check_report(const UnitreeConfig& config, const unitree::RobotFigures& robot,
                                 const UnitreeFindings& f) {
  std::string text = fmt::format("interface {}, domain {}\n", config.interface, config.domain);
  if (f.states.counters.received() > 0) {
    text += fmt::format("{}: {:.0f} states a second, longest gap {:.1f} ms, clock {:.0f} Hz, {}\n",
                        unitree::kStateTopic, f.states.rate_hz, 1e3 * f.states.longest_gap_s,
                        f.states.tick_rate_hz, crc_words(f.states.counters));
  }
  text += fmt::format("{}: {}, {} commands of other programs\n", unitree::kCommandTopic,
                      f.commands_are_read ? "read by the robot" : "NOT read", f.foreign_commands);
  text += fmt::format("sport mode: {}\n", mode_words(f));
  if (f.states.counters.taken > 0) text += unitree_state_table(config, robot, f.states.state);
  const std::vector<std::string> problems = unitree_check_problems(config, robot, f);
  if (problems.empty()) return text + "all is well; nothing was powered\n";
  text += fmt::format("{} {} wrong; nothing was powered\n", problems.size(),
                      problems.size() == 1 ? "thing is" : "things are");
  for (const std::string& problem : problems) text += "  " + problem + "\n";
  return text;
}

int run_unitree_check(const UnitreeConfig& config, const unitree::RobotFigures& robot) {
  unitree::RobotLink link(config, 0);
  UnitreeFindings findings;
  link.open_commands();  // and sends none
  findings.states = unitree::listen_to_states(link);
  findings.wrong_state_type = link.wrong_state_type();
  const std::int64_t end_ns = clock_ns(CLOCK_MONOTONIC) + kReaderTime_ns;
  while (!link.commands_are_read() && clock_ns(CLOCK_MONOTONIC) < end_ns) link.wait(end_ns);
  findings.commands_are_read = link.commands_are_read();
  findings.wrong_command_type = link.wrong_command_type();
  const auto answer =
      link.switcher().ask(unitree::SwitcherRequest::kCheckMode, kSwitcherTime_s,
                          [&] { link.wait(clock_ns(CLOCK_MONOTONIC) + 10'000'000); });
  if (answer && answer->code == 0) findings.mode = unitree::mode_name(answer->data);
  const bool live = isatty(STDIN_FILENO) != 0 && isatty(STDERR_FILENO) != 0;
  if (live && findings.states.counters.taken > 0) show_live(link, config, robot);
  findings.foreign_commands = link.foreign_commands();
  findings.states.counters = link.states().counters();
  findings.states.state = link.states().state();
  fmt::print("{}", unitree_check_report(config, robot, findings));
  return unitree_check_problems(config, robot, findings).empty() ? kExitOk : kExitFailed;
}

}  // namespace sandrunner
