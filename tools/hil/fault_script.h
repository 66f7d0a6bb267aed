// SPDX-License-Identifier: BSD-3-Clause
// Faults that the bench is to make, as a person writes them: "2.5 silent LF_KFE".
#pragma once

#include <cstdint>
#include <string>

#include "drivers/robot/hardware_config.h"
#include "rt/core/robot_description.h"

namespace sandrunner::hil {

enum class BenchFault : std::uint8_t {
  kSilent,           ///< a drive hears and says nothing any more
  kReboot,           ///< a drive is silent for so long, then back, and off
  kLoses,            ///< one of so many of a drive's replies is lost
  kSwapped,          ///< two drives have each other's identifier
  kScaled,           ///< a drive's numbers span so many times what is configured
  kMode,             ///< a Damiao is in this control mode
  kJumps,            ///< a drive's encoder jumps by so much, rad
  kTurns,            ///< on a stand, where nothing else moves: a hand turns a joint by so much, rad
  kCode,             ///< a drive reports this fault of its own
  kOverTemperature,  ///< a drive has this temperature, degrees C
  kReversed,         ///< a drive's torque acts the other way than it says
  kForeign,          ///< another program sends a drive so many set-points, one a millisecond
  kSecond,           ///< a second controller is started, if the bench started the first
  kStand,      ///< on a stand each joint turns under its drive's torque, and nothing else moves
  kBusOff,     ///< a bus goes off, and is on again after 0.1 s
  kLinkDown,   ///< a network interface is set down ...
  kLinkUp,     ///< ... and up
  kQueueFull,  ///< a network interface takes no frames (ENOBUFS)
  kImuSilent,
  kImuRepeats,
  kImuGarbage,
  kDead,  ///< the whole bench: no drive, no IMU
  kKill,  ///< SIGKILL to the controller, if the bench started it
};

/// One line of a script.
struct TimedFault {
  std::string text;  ///< as it was written
  /// s since all drives were first enabled together, or since the bench began.
  double at_s = 0.0;
  bool from_start = false;
  BenchFault kind = BenchFault::kDead;
  int first = 0, second = 0;  ///< joint or bus; the other joint
  double value = 0.0;
};

/// Reads "T KIND [JOINT|INTERFACE] [JOINT|NUMBER]", T a number, "start" or "start+NUMBER". Throws
/// InputError.
TimedFault read_fault(const std::string& text, const HardwareConfig& hardware,
                      const RobotDescription& robot);

/// The kinds and what they take, as lines for --help.
std::string fault_kinds_help();

}  // namespace sandrunner::hil
