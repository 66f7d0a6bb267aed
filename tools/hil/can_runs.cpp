// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "tools/hil/fault_runs.h"

namespace sandrunner::hil {
namespace {

constexpr const char* kDamping = "damping, then off";
constexpr const char* kLiesDown = "stops, stands, lies down, then off";
constexpr const char* kNotStarted = "nothing is enabled";

// A drive that receives nothing switches off by its own time-out, 50 ms in the examples. The robot
// stands up when the fault comes, but where another time is given: 6 s after, it walks.
constexpr auto kRuns = std::to_array<FaultRun>({
    {"drive-silent", "a drive is silent, in Walk", "6 silent LF_KFE", "joints_stale", "LF_KFE", "",
     kDamping, 1, 0.005, 0.052, "moteus"},
    {"drive-reboots", "a drive reboots in 0.3 s", "1 reboot LF_KFE 0.3", "joints_stale", "LF_KFE",
     "", kDamping, 1, 0.005, 0.052, "moteus"},
    {"drive-resets", "a drive is off at once, and answers", "1 reboot RF_HFE 0", "drive_fault",
     "RF_HFE", "switched off by itself", kDamping, 1, 0.006, 0.006, "moteus"},
    {"drive-resets-mit",
     "a drive is off at once, in Walk, and answers: MIT layout, whose replies do not report it",
     "6 reboot RF_KFE 0", "torque_missing", "RF_KFE", "", kDamping, 1, 0.15, 0.15, "mit"},
    // Three exchanges at 800 Hz without a reply, and the one that brings the command: 5 ms.
    {"damiao-reboots", "a Damiao reboots in 0.3 s, and with it forgets its time-out",
     "1 reboot LF_KFE 0.3", "joints_stale", "LF_KFE", "it has no time-out now", kDamping, 1, 0.006,
     0.052, "damiao"},
    {"replies-lost", "every tenth reply of a drive is lost", "0 loses RH_HFE 10", "", "", "",
     "walks on; counted", 0, 0.0, 0.0, "moteus"},
    {"bus-off", "a bus goes off (error frame), back after 0.1 s", "1 bus-off can1", "drive_fault",
     "RF_HAA RF_HFE RF_KFE", "BUS OFF", kDamping, 1, 0.003, 0.052, "moteus"},
    // On the one processor of the emulated machine the kernel holds up everybody for 12 ms to take
    // an interface down: the drives of all buses are late.
    {"link-down", "an interface goes down", "1 link-down can2", "joints_stale",
     "LF_HAA LF_HFE LF_KFE RF_HAA RF_HFE RF_KFE LH_HAA LH_HFE LH_KFE RH_HAA RH_HFE RH_KFE",
     "NOT SENT (the interface is down)", kDamping, 1, 0.005, 0.052, "moteus"},
    {"queue-full", "an interface takes no frames: its queue is full (ENOBUFS)", "1 queue-full can1",
     "joints_stale", "RF_HAA RF_HFE RF_KFE", "NOT SENT (the bus takes no frames)", kDamping, 1,
     0.005, 0.052, "moteus"},
    {"swapped-ids", "two drives have each other's id", "start swapped LF_HFE LF_KFE", "", "",
     "cannot be", kNotStarted, 2, 0.0, 0.0, "moteus"},
    {"wrong-scale", "a drive's numbers span what another model's do", "start scaled LF_KFE 0.131",
     "", "", "cannot be", kNotStarted, 2, 0.0, 0.0, "mit"},
    {"wrong-mode", "a Damiao is in another control mode", "start mode LF_KFE 2", "", "",
     "its control mode (1: MIT) is 2", kNotStarted, 2, 0.0, 0.0, "damiao"},
    {"encoder-jump", "an encoder jumps by 0.5 rad", "1 jumps RH_HFE 0.5", "encoder_jump", "RH_HFE",
     "", kDamping, 1, 0.004, 0.004, "moteus"},
    {"drive-fault", "a drive reports a fault of its own", "1 code LH_KFE 33", "drive_fault",
     "LH_KFE", "", kDamping, 1, 0.004, 0.004, "moteus"},
    {"drive-warm", "a drive is at 85 degrees C, in Walk", "6 hot LH_KFE 85", "drive_warning", "",
     "too hot", kLiesDown, 1, 0.0, 0.0, "mit"},
    {"drive-hot", "a drive is at 95 degrees C", "1 hot LH_KFE 95", "drive_fault", "LH_KFE",
     "too hot", kDamping, 1, 0.004, 0.004, "mit"},
    {"imu-silent", "the IMU is silent", "1 imu-silent", "imu_stale", "", "", kDamping, 1, 0.034,
     0.034, "moteus"},
    {"imu-repeats", "the IMU repeats its last packet", "1 imu-repeats", "imu_stale", "", "REPEATED",
     kDamping, 1, 0.034, 0.034, "moteus"},
    {"imu-garbage", "the IMU sends garbage", "1 imu-garbage", "imu_stale", "", "bytes skipped",
     kDamping, 1, 0.034, 0.034, "moteus"},
    {"foreign-mit", "another program sends a drive set-points, in Walk: MIT layout",
     "6 foreign RF_HFE 1000", "foreign_traffic", "RF_HFE", "COMMANDS OF ANOTHER PROGRAM", kDamping,
     1, 0.004, 0.004, "mit"},
    {"foreign-moteus", "another program sends a drive set-points, in Walk: moteus",
     "6 foreign RF_HFE 1000", "foreign_traffic", "RF_HFE", "COMMANDS OF ANOTHER PROGRAM", kDamping,
     1, 0.004, 0.004, "moteus"},
    {"second-controller", "a second controller is started in Walk, with another IMU", "6 second",
     "", "", "expected a silent bus", "walks on; the second refuses, sends nothing", 0, 0.0, 0.0,
     "mit"},
    {"controller-killed", "SIGKILL to the controller in Walk: moteus", "6 kill", "", "", "",
     "the drives' time-out damps", kKilled, 0.052, 0.052, "moteus"},
    {"controller-killed-mit", "SIGKILL to the controller in Walk: MIT layout", "6 kill", "", "", "",
     "the drives' time-out switches them off", kKilled, 0.052, 0.052, "mit"},
    // On the one processor of the emulated machine the silence of 50 ms tells the guard, before the
    // killed process has ended.
    {"guard-after-kill", "the same with drives that have no time-out", "0 untimed; 6 kill", "", "",
     "", "the guard switches them off", kKilled, 0.054, 0.054, "mit"},
    {"guard-after-stop", "SIGSTOP to the controller in Walk: drives that have no time-out",
     "0 untimed; 6 stop", "", "", "", "the guard switches them off", kNoMatter, 0.054, 0.054,
     "mit"},
    {"bench-dead", "all drives and the IMU are gone", "1 dead", "joints_stale",
     "LF_HAA LF_HFE LF_KFE RF_HAA RF_HFE RF_KFE LH_HAA LH_HFE LH_KFE RH_HAA RH_HFE RH_KFE", "",
     "the drives' time-out damps", 1, 0.0, 0.052, "moteus"},
    {"walks-mit", "nothing", "", "", "", "", "walks", 0, 0.0, 0.0, "mit"},
    {"walks-damiao", "nothing", "", "", "", "", "walks", 0, 0.0, 0.0, "damiao"},
    {"walks-moteus", "nothing", "", "", "", "", "walks", 0, 0.0, 0.0, "moteus"},
});

}  // namespace

std::span<const FaultRun> can_fault_runs() { return kRuns; }

}  // namespace sandrunner::hil
