// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "tools/hil/fault_runs.h"

namespace sandrunner::hil {
namespace {

constexpr const char* kDamping = "damping, then off";
constexpr const char* kLiesDown = "stops, stands, lies down, then off";
constexpr const char* kWalksOn = "walks on; counted";
constexpr const char* kWire = "the wire damps, then off";
constexpr const char* kGuard = "the wire's guard damps, then off";
constexpr const char* kNotStarted = "nothing is commanded";
constexpr const char* kStale = "joints_stale";
constexpr const char* kForeign = "ANOTHER PROGRAM COMMANDS THE ROBOT";

// Joint values are a fault when they are 10 ms old; the state before was up to 2 ms old when the
// fault began, and a command takes up to 2 ms to the wire and 2 ms to the robot's next look.
constexpr double kStale_s = 0.016, kAtOnce_s = 0.008, kWire_s = 0.052;
// The guard joins the domain first.
constexpr double kGuard_s = 0.1;

constexpr auto kRuns = std::to_array<FaultRun>({
    {"gap-4", "states are missing for 4 ms", "1 gap 4", "", "", "", kWalksOn, 0, 0.0},
    {"gap-6", "states are missing for 6 ms", "1 gap 6", "", "", "", kWalksOn, 0, 0.0},
    {"gap-12", "states are missing for 12 ms", "1 gap 12", kStale, kAllJoints, "", kDamping, 1,
     kStale_s},
    {"gap-20", "states are missing for 20 ms", "1 gap 20", kStale, kAllJoints, "", kDamping, 1,
     kStale_s},
    {"gap-50", "states are missing for 50 ms", "1 gap 50", kStale, kAllJoints, "", kDamping, 1,
     kStale_s},
    {"gap-100", "states are missing for 100 ms", "1 gap 100", kStale, kAllJoints, "", kDamping, 1,
     kStale_s},
    {"silent", "states are missing from now on", "1 silent", kStale, kAllJoints, "", kDamping, 1,
     kStale_s},
    {"burst-6", "states are held up for 6 ms, then come at once", "1 burst 6", "", "", "", kWalksOn,
     0, 0.0},
    {"burst-100", "states are held up for 100 ms, then come at once", "1 burst 100", kStale,
     kAllJoints, "", kDamping, 1, kStale_s},
    {"late", "states are late by 20 ms from now on", "1 late 20", kStale, kAllJoints, "", kDamping,
     1, kStale_s},
    {"jitter", "states are late by up to 3 ms, by chance", "1 jitter 3", "", "", "", kWalksOn, 0,
     0.0},
    {"loses", "every tenth state is lost", "1 loses 10", "", "", "", kWalksOn, 0, 0.0},
    {"bad-crc", "states have a wrong CRC", "1 bad-crc", kStale, kAllJoints, "with a WRONG CRC",
     kDamping, 1, kStale_s},
    {"no-crc", "states have no CRC", "1 no-crc", "", "", "without a CRC", kWalksOn, 0, 0.0},
    {"nan", "a joint's position is not a number", "1 nan {}", kStale, kAllJoints, "NOT FINITE",
     kDamping, 1, kStale_s},
    {"stuck", "the clock in the states stands still", "1 stuck", kStale, kAllJoints, "REPEATED",
     kDamping, 1, kStale_s},
    {"backwards", "the clock in the states goes back by 1 s", "1 backwards", kStale, kAllJoints,
     "WENT BACK", kDamping, 1, kStale_s},
    {"lost", "the robot's own bus hears no more of a motor", "1 lost {}", kStale, kThatJoint,
     "lost by the robot's own bus", kDamping, 1, kStale_s},
    {"warm", "a motor is at 85 degrees C, in Walk", "6 hot {} 85", "drive_warning", "", "too hot",
     kLiesDown, 1, 0.0},
    {"hot", "a motor is at 95 degrees C", "1 hot {} 95", "drive_fault", kThatJoint, "too hot",
     kDamping, 1, kAtOnce_s},
    {"mode", "a motor is off by itself", "1 mode {} 0", "drive_fault", kThatJoint,
     "another mode than commanded", kDamping, 1, kAtOnce_s},
    {"battery-low", "the battery has 8 %, in Walk", "6 battery 8", "drive_warning", "",
     "battery low", kLiesDown, 1, 0.0},
    {"battery", "the battery has 4 %", "1 battery 4", "drive_fault", kAllJoints, "battery low",
     kDamping, 1, kAtOnce_s},
    {"foreign", "another program sends one command", "1 foreign 1", "foreign_traffic", kAllJoints,
     kForeign, "damping for 10 ms, then silence", 1, kAtOnce_s},
    {"sport", "sport mode is on again, and commands the robot", "1 sport", "foreign_traffic",
     kAllJoints, kForeign, "damping for 10 ms, then silence", 1, kAtOnce_s},
    {"remote-stop", "L2 and B of the remote are pressed", "1 remote-stop", "emergency_stop", "", "",
     kDamping, 1, kAtOnce_s},
    {"remote-lost", "the remote is switched off", "1 remote-lost", "emergency_stop", "", "",
     kDamping, 1, 0.21},
    {"wrong-type", "states are of another type", "start wrong-type", "", "",
     "found another type than unitree_go::msg::dds_::LowState_", kNotStarted, 2, 0.0},
    {"wrong-interface", "the network interface is another one", "", "", "", "nosuch0", kNotStarted,
     2, 0.0, 0.0, "", "hardware.unitree.interface=nosuch0"},
    {"sport-start", "sport mode commands the robot after its release", "start sport", "", "",
     "commands of another program", kNotStarted, 2, 0.0},
    {"no-remote", "the remote is off at the start", "start remote-lost", "", "",
     "remote control: found none", kNotStarted, 2, 0.0},
    {"kill", "SIGKILL to the controller, in Walk; the firmware holds commands", "6 kill", "", "",
     "", kWire, kKilled, kWire_s},
    {"kill-damps", "the same; the firmware damps after 100 ms", "start firmware-damps; 6 kill", "",
     "", "", kWire, kKilled, kWire_s},
    {"crash", "SIGSEGV to the controller; the firmware holds commands", "1 crash", "", "", "",
     kWire, kNoMatter, kWire_s},
    {"crash-damps", "the same; the firmware damps after 100 ms", "start firmware-damps; 1 crash",
     "", "", "", kWire, kNoMatter, kWire_s},
    {"stop", "SIGSTOP to the controller; the firmware holds commands", "1 stop", "", "", "", kWire,
     kNoMatter, kWire_s},
    {"stop-damps", "the same; the firmware damps after 100 ms", "start firmware-damps; 1 stop", "",
     "", "", kWire, kNoMatter, kWire_s},
    {"hang", "the control thread hangs; the firmware holds commands", "1 hang", "", "",
     "the control thread hangs", kWire, 1, kWire_s},
    {"hang-damps", "the same; the firmware damps after 100 ms", "start firmware-damps; 1 hang", "",
     "", "the control thread hangs", kWire, 1, kWire_s},
    {"wire-kill", "SIGKILL to the wire; the firmware holds commands", "1 wire-kill", kStale,
     kAllJoints, "", kGuard, 1, kGuard_s},
    {"wire-kill-damps", "the same; the firmware damps after 100 ms",
     "start firmware-damps; 1 wire-kill", kStale, kAllJoints, "", kGuard, 1, kGuard_s},
    {"walks", "nothing", "", "", "", "", "walks", 0, 0.0},
});

}  // namespace

std::span<const FaultRun> unitree_fault_runs() { return kRuns; }

}  // namespace sandrunner::hil
