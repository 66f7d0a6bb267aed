// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/bring_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"

namespace sandrunner::unitree {
namespace {

constexpr double kLeastRate_hz = 400.0;
constexpr double kTickTolerance = 0.05;
constexpr double kPastStop_rad = 0.1;
constexpr double kFolded_rad = 0.6;
constexpr double kMostBad = 0.01;  // share of the states

constexpr double kAnswer_s = 2.0;
constexpr double kBetweenReleases_s = 1.0;
constexpr int kMostReleases = 10;
constexpr int kProofs = 2;  // looks in a row at which no program of the robot's controls it
constexpr double kRead_s = 2.0;
constexpr double kLook_s = 0.05;  // whether to go on

std::int64_t after_s(double time_s) {
  return clock_ns(CLOCK_MONOTONIC) + static_cast<std::int64_t>(1e9 * time_s);
}

/// Listens for this long; false: it should not go on.
bool pass(RobotLink& link, double time_s, const std::function<bool()>& may_go_on) {
  const std::int64_t end_ns = after_s(time_s);
  while (clock_ns(CLOCK_MONOTONIC) < end_ns) {
    link.wait(std::min(end_ns, after_s(kLook_s)));
    if (!may_go_on()) return false;
  }
  return true;
}

[[noreturn]] void fail(const std::string& what) { throw InputError("hardware.unitree: " + what); }

std::string active_mode(RobotLink& link) {
  const auto answer = link.switcher().ask(SwitcherRequest::kCheckMode, kAnswer_s,
                                          [&] { link.wait(after_s(0.01)); });
  if (!answer) {
    fail(
        "motion_switcher: found no answer on whether sport mode is on, expected firmware 1.0.24 or "
        "later; if sport mode is off already: hardware.unitree.release_sport_mode=false");
  }
  const auto name = mode_name(answer->data);
  if (answer->code != 0 || !name) {
    fail(fmt::format("motion_switcher: found the answer {} '{}', expected the name of a mode",
                     answer->code, answer->data));
  }
  return *name;
}

void release_sport_mode(RobotLink& link, const RobotFigures& robot,
                        const std::function<bool()>& may_go_on) {
  int proofs = 0;
  for (int releases = 0; proofs < kProofs;) {
    const std::string mode = active_mode(link);
    if (mode.empty()) {
      ++proofs;
    } else {
      proofs = 0;
      if (!lies(robot, link.states().state())) {
        fail(
            fmt::format("the robot's own controller '{}' holds it on its legs: found no folded "
                        "knees, expected a robot that lies (remote: L2 with A)",
                        mode));
      }
      if (++releases > kMostReleases) {
        fail(
            fmt::format("the robot's own controller '{}' comes back after {} releases: switch it "
                        "off in the maker's app",
                        mode, kMostReleases));
      }
      link.switcher().ask(SwitcherRequest::kReleaseMode, kAnswer_s,
                          [&] { link.wait(after_s(0.01)); });
    }
    if (!pass(link, kBetweenReleases_s, may_go_on)) return;
  }
}

}  // namespace

RobotFigures figures_of(const RobotDescription& robot, const GateConfig& gate,
                        const LegJoints<double>& damping_kd_nmsprad) {
  return {.joint_names = robot.joint_names,
          .lower_rad = gate.joint_lower_rad,
          .upper_rad = gate.joint_upper_rad,
          .lying_rad = gate.lying_rad,
          .damping_kd_nmsprad = damping_kd_nmsprad};
}

StateFigures listen_to_states(RobotLink& link, const std::function<bool()>& may_go_on) {
  StateWatch& states = link.states();
  const std::int64_t first_ns = after_s(kFirstState_s);
  while (states.counters().received() == 0 && clock_ns(CLOCK_MONOTONIC) < first_ns && may_go_on()) {
    link.wait(std::min(first_ns, after_s(kLook_s)));
  }
  states.begin_figures();
  if (states.counters().received() > 0) pass(link, kListen_s, may_go_on);
  return {.state = states.state(),
          .counters = states.counters(),
          .rate_hz = states.rate_hz(),
          .longest_gap_s = states.longest_gap_s(),
          .tick_rate_hz = states.tick_rate_hz()};
}

std::vector<std::string> state_problems(const UnitreeConfig& config, const RobotFigures& robot,
                                        const StateFigures& f, bool wrong_type) {
  std::vector<std::string> lines;
  const StateCounters& c = f.counters;
  if (c.received() == 0) {
    lines.push_back(
        wrong_type
            ? fmt::format("{}: found another type than unitree_go::msg::dds_::LowState_ under its "
                          "name, expected that of a Go2",
                          kStateTopic)
            : fmt::format("{}: found no state in {} s on interface {}, domain {}: is the robot on, "
                          "the cable in, and this computer's address 192.168.123.x?",
                          kStateTopic, kFirstState_s, config.interface, config.domain));
    return lines;
  }
  const auto all = static_cast<double>(c.received());
  const auto too_many = [&](std::uint64_t count, const char* what) {
    if (static_cast<double>(count) <= kMostBad * all) return;
    lines.push_back(
        fmt::format("{}: found {} of {} states with {}", kStateTopic, count, c.received(), what));
  };
  too_many(c.bad_crc, "a wrong CRC");
  too_many(c.not_finite, "a number that is not finite");
  too_many(c.repeated, "the clock of the one before");
  too_many(c.old, "a clock that went back");
  if (c.taken < 2) return lines;
  if (f.rate_hz < kLeastRate_hz) {
    lines.push_back(
        fmt::format("{}: found {:.0f} states a second, expected 500", kStateTopic, f.rate_hz));
  }
  if (std::fabs(f.tick_rate_hz - config.tick_hz) > kTickTolerance * config.tick_hz) {
    lines.push_back(
        fmt::format("{}: found a clock with {:.0f} ticks a second, expected {} (hardware.unitree."
                    "tick_hz)",
                    kStateTopic, f.tick_rate_hz, config.tick_hz));
  }
  for (int j = 0; j < kNumJoints; ++j) {
    const double q = f.state.position_rad[j];
    if (q < robot.lower_rad[j] - kPastStop_rad || q > robot.upper_rad[j] + kPastStop_rad) {
      lines.push_back(fmt::format("{}: found it at {:.3f} rad, expected {:.3f} to {:.3f}",
                                  robot.joint_names[j], q, robot.lower_rad[j], robot.upper_rad[j]));
    }
    if (f.state.temperature_degc[j] > config.temperature_limit_degc) {
      lines.push_back(fmt::format("{}: found {} degrees C, expected at most {}",
                                  robot.joint_names[j], f.state.temperature_degc[j],
                                  config.temperature_limit_degc));
    }
  }
  if (f.state.battery_percent < config.low_battery_percent) {
    lines.push_back(fmt::format("battery: found {} %, expected {} % or more",
                                f.state.battery_percent, config.low_battery_percent));
  }
  if (config.need_remote && !f.state.remote.on) {
    lines.emplace_back(
        "remote control: found none, expected one that is on (its L2 with B is the emergency "
        "stop); without one: hardware.unitree.need_remote=false");
  }
  if (f.state.remote.stop) lines.emplace_back("remote control: L2 and B are pressed");
  return lines;
}

bool lies(const RobotFigures& robot, const RobotState& state) noexcept {
  for (int knee = 2; knee < kNumJoints; knee += kJointsPerLeg) {
    if (std::fabs(state.position_rad[knee] - robot.lying_rad[knee]) > kFolded_rad) return false;
  }
  return true;
}

void bring_up(RobotLink& link, const UnitreeConfig& config, const RobotFigures& robot,
              const std::function<bool()>& may_go_on) {
  const StateFigures figures = listen_to_states(link, may_go_on);
  if (!may_go_on()) return;
  const auto problems = state_problems(config, robot, figures, link.wrong_state_type());
  if (!problems.empty()) fail(problems.front());
  if (config.release_sport_mode) release_sport_mode(link, robot, may_go_on);
  const std::uint64_t foreign = link.foreign_commands();
  if (!pass(link, kListen_s, may_go_on)) return;
  if (const std::uint64_t found = link.foreign_commands() - foreign; found > 0) {
    fail(fmt::format("{}: found {} commands of another program in {} s, expected none: end it",
                     kCommandTopic, found, kListen_s));
  }
  link.open_commands();
  const std::int64_t end_ns = after_s(kRead_s);
  while (!link.commands_are_read() && clock_ns(CLOCK_MONOTONIC) < end_ns) {
    if (!pass(link, 0.02, may_go_on)) return;
  }
  if (link.commands_are_read()) return;
  if (link.wrong_command_type()) {
    fail(
        fmt::format("{}: found a reader of another type than unitree_go::msg::dds_::LowCmd_ under "
                    "its name, expected that of a Go2",
                    kCommandTopic));
  }
  fail(fmt::format("{}: found no reader of commands, expected the robot", kCommandTopic));
}

}  // namespace sandrunner::unitree
