// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/unitree_script.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner::hil {
namespace {

using Kind = UnitreeFaultKind;

struct KindRow {
  Kind kind;
  const char* name;
  bool joint, number;
  const char* help;
};

constexpr auto kKinds = std::to_array<KindRow>({
    {Kind::kGap, "gap", false, true, "MS: no states for this long"},
    {Kind::kBurst, "burst", false, true, "MS: states are held up for this long, then come at once"},
    {Kind::kJitter, "jitter", false, true, "MS: each state is late by up to this, by chance"},
    {Kind::kLate, "late", false, true, "MS: each state is late by this"},
    {Kind::kLoses, "loses", false, true, "N: one of N states is lost"},
    {Kind::kSilent, "silent", false, false, "no states any more"},
    {Kind::kBadCrc, "bad-crc", false, false, "states with a wrong CRC"},
    {Kind::kNoCrc, "no-crc", false, false, "states without a CRC"},
    {Kind::kNan, "nan", true, false, "JOINT: its position is not a number"},
    {Kind::kStuck, "stuck", false, false, "the clock in the states stands still"},
    {Kind::kBackwards, "backwards", false, false, "the clock in the states goes back by 1 s"},
    {Kind::kLost, "lost", true, false, "JOINT: the robot's own bus hears no more of its motor"},
    {Kind::kHot, "hot", true, true, "JOINT DEGC: temperature of its motor"},
    {Kind::kMode, "mode", true, true, "JOINT N: mode that its motor reports"},
    {Kind::kBattery, "battery", false, true, "PERCENT: what the battery has"},
    {Kind::kForeign, "foreign", false, true, "N: another program sends N commands, at 500 Hz"},
    {Kind::kSport, "sport", false, false, "sport mode is on again, and commands the robot"},
    {Kind::kRemoteStop, "remote-stop", false, false, "L2 and B of the remote are pressed"},
    {Kind::kRemoteLost, "remote-lost", false, false, "the remote is switched off"},
    {Kind::kWrongType, "wrong-type", false, false, "states are of another type (at `start`)"},
    {Kind::kFirmwareDamps, "firmware-damps", false, false,
     "without commands for 100 ms the robot damps; else it holds the last one"},
    {Kind::kKill, "kill", false, false, "SIGKILL to the controller (runs only)"},
    {Kind::kCrash, "crash", false, false, "SIGSEGV to the controller (runs only)"},
    {Kind::kStop, "stop", false, false, "SIGSTOP to the controller (runs only)"},
    {Kind::kHang, "hang", false, false, "the controller's control thread stops (runs only)"},
    {Kind::kWireKill, "wire-kill", false, false, "SIGKILL to the wire's process (runs only)"},
});

}  // namespace

TimedUnitreeFault read_unitree_fault(const std::string& text, const RobotDescription& robot) {
  std::istringstream words(text);
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw InputError(fmt::format("--fault '{}': found {}, expected {}", text, found, expected));
  };
  const auto word = [&](const char* expected) {
    std::string next;
    if (!(words >> next)) fail("no more", expected);
    return next;
  };
  const auto number = [&](const std::string& from, const char* expected) {
    std::istringstream in(from);
    double value = 0.0;
    if (!(in >> value) || !in.eof()) fail("'" + from + "'", expected);
    return value;
  };
  TimedUnitreeFault fault;
  fault.text = text;
  const char* const times = "a time in s, or start";
  const std::string time = word(times);
  fault.from_start = time == "start";
  if (!fault.from_start) fault.at_s = number(time, times);
  if (!(fault.at_s >= 0.0)) fail("a negative time", times);
  const std::string name = word("a kind of fault");
  const auto kind =
      std::ranges::find_if(kKinds, [&](const KindRow& row) { return name == row.name; });
  if (kind == kKinds.end()) {
    std::vector<const char*> names;
    for (const KindRow& row : kKinds) names.push_back(row.name);
    fail("'" + name + "'", fmt::format("one of {}", fmt::join(names, ", ")));
  }
  fault.kind = kind->kind;
  if (kind->joint) {
    const std::string joint = word("a joint");
    const auto found = std::ranges::find(robot.joint_names, joint);
    if (found == robot.joint_names.end()) {
      fail("'" + joint + "'", fmt::format("one of {}", fmt::join(robot.joint_names, ", ")));
    }
    fault.joint = static_cast<int>(found - robot.joint_names.begin());
  }
  if (kind->number) fault.value = number(word("a number"), "a number");
  std::string more;
  if (words >> more) fail("'" + more + "'", "no more");
  return fault;
}

std::string unitree_fault_kinds_help() {
  std::string lines;
  for (const KindRow& kind : kKinds) lines += fmt::format("  {:<14} {}\n", kind.name, kind.help);
  return lines;
}

}  // namespace sandrunner::hil
