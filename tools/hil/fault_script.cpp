// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_script.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner::hil {
namespace {

/// What follows a kind's name.
enum class Takes : std::uint8_t { kNothing, kJoint, kJointAndNumber, kTwoJoints, kBus };

struct Kind {
  BenchFault kind;
  const char* name;
  Takes takes;
  const char* help;
};

constexpr std::array<Kind, 23> kKinds = {{
    {BenchFault::kSilent, "silent", Takes::kJoint, "JOINT: the drive receives and sends nothing"},
    {BenchFault::kReboot, "reboot", Takes::kJointAndNumber, "JOINT S: off, and back after S s"},
    {BenchFault::kLoses, "loses", Takes::kJointAndNumber, "JOINT N: one of N replies is lost"},
    {BenchFault::kSwapped, "swapped", Takes::kTwoJoints, "JOINT JOINT: each has the other's id"},
    {BenchFault::kScaled, "scaled", Takes::kJointAndNumber,
     "JOINT X: its numbers span X times what is configured (MIT layout)"},
    {BenchFault::kMode, "mode", Takes::kJointAndNumber, "JOINT N: its control mode (Damiao)"},
    {BenchFault::kJumps, "jumps", Takes::kJointAndNumber, "JOINT RAD: its encoder jumps"},
    {BenchFault::kTurns, "turns", Takes::kJointAndNumber, "JOINT RAD: a hand turns it, on a stand"},
    {BenchFault::kCode, "code", Takes::kJointAndNumber, "JOINT N: a fault of its own"},
    {BenchFault::kOverTemperature, "hot", Takes::kJointAndNumber, "JOINT DEGC: its temperature"},
    {BenchFault::kReversed, "reversed", Takes::kJoint, "JOINT: its torque acts the other way"},
    {BenchFault::kForeign, "foreign", Takes::kJointAndNumber,
     "JOINT N: another program sends it N set-points, at 1 kHz"},
    {BenchFault::kSecond, "second", Takes::kNothing, "a second controller starts (runs only)"},
    {BenchFault::kStand, "stand", Takes::kNothing,
     "on a stand, where each joint turns under its drive's torque"},
    {BenchFault::kBusOff, "bus-off", Takes::kBus, "INTERFACE: off for 0.1 s"},
    {BenchFault::kLinkDown, "link-down", Takes::kBus, "INTERFACE: set down"},
    {BenchFault::kLinkUp, "link-up", Takes::kBus, "INTERFACE: set up"},
    {BenchFault::kQueueFull, "queue-full", Takes::kBus, "INTERFACE: takes no frames (ENOBUFS)"},
    {BenchFault::kImuSilent, "imu-silent", Takes::kNothing, "the IMU sends nothing"},
    {BenchFault::kImuRepeats, "imu-repeats", Takes::kNothing, "the IMU repeats its last packet"},
    {BenchFault::kImuGarbage, "imu-garbage", Takes::kNothing, "the IMU sends garbage"},
    {BenchFault::kDead, "dead", Takes::kNothing, "the whole bench ends"},
    {BenchFault::kKill, "kill", Takes::kNothing, "SIGKILL to the controller (runs only)"},
}};

class Reader {
 public:
  Reader(const std::string& text, const HardwareConfig& hardware, const RobotDescription& robot)
      : text_(text), hardware_(hardware), robot_(robot), words_(text) {}

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError(fmt::format("--fault '{}': found {}, expected {}", text_, found, expected));
  }

  std::string word(const char* expected) {
    std::string word;
    if (!(words_ >> word)) fail("no more", expected);
    return word;
  }
  double number(const char* what) { return number(word(what), what); }
  double number(const std::string& text, const char* what) {
    std::istringstream in(text);
    double value = 0.0;
    if (!(in >> value) || !in.eof()) fail("'" + text + "'", what);
    return value;
  }
  int joint() {
    const std::string name = word("a joint");
    const auto found = std::find(robot_.joint_names.begin(), robot_.joint_names.end(), name);
    if (found == robot_.joint_names.end()) {
      fail("'" + name + "'", fmt::format("one of {}", fmt::join(robot_.joint_names, ", ")));
    }
    return static_cast<int>(found - robot_.joint_names.begin());
  }
  int bus() {
    const std::string name = word("an interface");
    std::vector<std::string> names;
    for (const BusConfig& bus : hardware_.buses) {
      if (bus.interface == name) return static_cast<int>(names.size());
      names.push_back(bus.interface);
    }
    fail("'" + name + "'", fmt::format("one of {}", fmt::join(names, ", ")));
  }
  void end() {
    std::string more;
    if (words_ >> more) fail("'" + more + "'", "no more");
  }

 private:
  const std::string& text_;
  const HardwareConfig& hardware_;
  const RobotDescription& robot_;
  std::istringstream words_;
};

}  // namespace

TimedFault read_fault(const std::string& text, const HardwareConfig& hardware,
                      const RobotDescription& robot) {
  Reader reader(text, hardware, robot);
  TimedFault fault;
  fault.text = text;
  const char* const times = "a time in s, start, or start+S";
  const std::string time = reader.word(times), after = "start+";
  fault.from_start = time == "start" || time.starts_with(after);
  if (time != "start") {
    fault.at_s = reader.number(fault.from_start ? time.substr(after.size()) : time, times);
  }
  if (!(fault.at_s >= 0.0)) reader.fail("a negative time", times);
  const std::string name = reader.word("a kind of fault");
  const auto kind =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& k) { return name == k.name; });
  if (kind == kKinds.end()) {
    std::vector<const char*> names;
    for (const Kind& k : kKinds) names.push_back(k.name);
    reader.fail("'" + name + "'", fmt::format("one of {}", fmt::join(names, ", ")));
  }
  fault.kind = kind->kind;
  switch (kind->takes) {
    case Takes::kNothing:
      break;
    case Takes::kJointAndNumber:
      fault.first = reader.joint();
      fault.value = reader.number("a number");
      break;
    case Takes::kJoint:
      fault.first = reader.joint();
      break;
    case Takes::kTwoJoints:
      fault.first = reader.joint();
      fault.second = reader.joint();
      break;
    case Takes::kBus:
      fault.first = reader.bus();
      break;
  }
  reader.end();
  return fault;
}

std::string fault_kinds_help() {
  std::string lines;
  for (const Kind& kind : kKinds) lines += fmt::format("  {:<12} {}\n", kind.name, kind.help);
  return lines;
}

}  // namespace sandrunner::hil
