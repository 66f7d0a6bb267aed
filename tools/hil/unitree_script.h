// SPDX-License-Identifier: BSD-3-Clause
// Faults of an emulated Unitree robot, as a person writes them: "2.5 gap 20".
#pragma once

#include <cstdint>
#include <string>

#include "rt/core/robot_description.h"

namespace sandrunner::hil {

enum class UnitreeFaultKind : std::uint8_t {
  kGap,            ///< no states for so many ms
  kBurst,          ///< states are held up for so many ms, then come at once
  kJitter,         ///< each state is late by up to so many ms, by chance
  kLate,           ///< each state is late by so many ms
  kLoses,          ///< one of so many states is lost
  kSilent,         ///< no states any more
  kBadCrc,         ///< states have a wrong CRC
  kNoCrc,          ///< states have no CRC
  kNan,            ///< a joint's position is not a number
  kStuck,          ///< the clock in the states stands still
  kBackwards,      ///< the clock in the states goes back by a second, once
  kLost,           ///< the robot's own bus hears no more of a motor
  kHot,            ///< a motor has this temperature, degrees C
  kMode,           ///< a motor reports this mode
  kBattery,        ///< the battery has so many percent
  kForeign,        ///< another program sends so many commands, 500 a second
  kSport,          ///< sport mode is on again, and commands the robot
  kRemoteStop,     ///< L2 and B of the remote control are pressed
  kRemoteLost,     ///< the remote control is switched off
  kWrongType,      ///< states are of another type; from the start
  kFirmwareDamps,  ///< without commands for 100 ms the robot damps; else the last one holds
  kKill,           ///< SIGKILL to the controller, if the bench started it
  kCrash,          ///< SIGSEGV
  kStop,           ///< SIGSTOP
  kHang,           ///< its control thread stops, its others go on
  kWireKill,       ///< SIGKILL to the wire's process
};

/// One line of a script.
struct TimedUnitreeFault {
  std::string text;  ///< as it was written
  /// s since all motors were first commanded together, or since the bench began.
  double at_s = 0.0;
  bool from_start = false;
  UnitreeFaultKind kind = UnitreeFaultKind::kSilent;
  int joint = 0;
  double value = 0.0;
};

/// Reads "T KIND [JOINT] [NUMBER]", T a number or "start". Throws InputError.
TimedUnitreeFault read_unitree_fault(const std::string& text, const RobotDescription& robot);

/// The kinds and what they take, as lines for --help.
std::string unitree_fault_kinds_help();

}  // namespace sandrunner::hil
