// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_runs.h"

#include <fmt/format.h>

#include <array>

namespace sandrunner::hil {
namespace {

constexpr const char* kDamping = "damping, then off";
constexpr const char* kLiesDown = "stops, stands, lies down, then off";
constexpr const char* kNotStarted = "nothing is enabled";

// A drive that receives nothing switches off by its own time-out, 50 ms in the examples. The robot
// stands up when the fault comes, but where another time is given: 6 s after, it walks.
constexpr std::array<FaultRun, 28> kRuns = {{
    {"drive-silent", "a drive is silent, in Walk", "moteus", "6 silent LF_KFE", "joints_stale",
     "LF_KFE", "", kDamping, 1, 0.005, 0.052},
    {"drive-reboots", "a drive reboots in 0.3 s", "moteus", "1 reboot LF_KFE 0.3", "joints_stale",
     "LF_KFE", "", kDamping, 1, 0.005, 0.052},
    {"drive-resets", "a drive is off at once, and answers", "moteus", "1 reboot RF_HFE 0",
     "drive_fault", "RF_HFE", "switched off by itself", kDamping, 1, 0.006, 0.006},
    {"drive-resets-mit",
     "a drive is off at once, in Walk, and answers: MIT layout, whose replies do not report it",
     "mit", "6 reboot RF_KFE 0", "torque_missing", "RF_KFE", "", kDamping, 1, 0.15, 0.15},
    // Three exchanges at 800 Hz without a reply, and the one that brings the command: 5 ms.
    {"damiao-reboots", "a Damiao reboots in 0.3 s, and with it forgets its time-out", "damiao",
     "1 reboot LF_KFE 0.3", "joints_stale", "LF_KFE", "it has no time-out now", kDamping, 1, 0.006,
     0.052},
    {"replies-lost", "every tenth reply of a drive is lost", "moteus", "0 loses RH_HFE 10", "", "",
     "", "walks on; counted", 0, 0.0, 0.0},
    {"bus-off", "a bus goes off (error frame), back after 0.1 s", "moteus", "1 bus-off can1",
     "drive_fault", "RF_HAA RF_HFE RF_KFE", "BUS OFF", kDamping, 1, 0.003, 0.052},
    // On the one processor of the emulated machine the kernel holds up everybody for 12 ms to take
    // an interface down: the drives of all buses are late.
    {"link-down", "an interface goes down", "moteus", "1 link-down can2", "joints_stale",
     "LF_HAA LF_HFE LF_KFE RF_HAA RF_HFE RF_KFE LH_HAA LH_HFE LH_KFE RH_HAA RH_HFE RH_KFE",
     "NOT SENT (the interface is down)", kDamping, 1, 0.005, 0.052},
    {"queue-full", "an interface takes no frames: its queue is full (ENOBUFS)", "moteus",
     "1 queue-full can1", "joints_stale", "RF_HAA RF_HFE RF_KFE",
     "NOT SENT (the bus takes no frames)", kDamping, 1, 0.005, 0.052},
    {"swapped-ids", "two drives have each other's id", "moteus", "start swapped LF_HFE LF_KFE", "",
     "", "cannot be", kNotStarted, 2, 0.0, 0.0},
    {"wrong-scale", "a drive's numbers span what another model's do", "mit",
     "start scaled LF_KFE 0.131", "", "", "cannot be", kNotStarted, 2, 0.0, 0.0},
    {"wrong-mode", "a Damiao is in another control mode", "damiao", "start mode LF_KFE 2", "", "",
     "its control mode (1: MIT) is 2", kNotStarted, 2, 0.0, 0.0},
    {"encoder-jump", "an encoder jumps by 0.5 rad", "moteus", "1 jumps RH_HFE 0.5", "encoder_jump",
     "RH_HFE", "", kDamping, 1, 0.004, 0.004},
    {"drive-fault", "a drive reports a fault of its own", "moteus", "1 code LH_KFE 33",
     "drive_fault", "LH_KFE", "", kDamping, 1, 0.004, 0.004},
    {"drive-warm", "a drive is at 85 degrees C, in Walk", "mit", "6 hot LH_KFE 85", "drive_warning",
     "", "too hot", kLiesDown, 1, 0.0, 0.0},
    {"drive-hot", "a drive is at 95 degrees C", "mit", "1 hot LH_KFE 95", "drive_fault", "LH_KFE",
     "too hot", kDamping, 1, 0.004, 0.004},
    {"imu-silent", "the IMU is silent", "moteus", "1 imu-silent", "imu_stale", "", "", kDamping, 1,
     0.034, 0.034},
    {"imu-repeats", "the IMU repeats its last packet", "moteus", "1 imu-repeats", "imu_stale", "",
     "REPEATED", kDamping, 1, 0.034, 0.034},
    {"imu-garbage", "the IMU sends garbage", "moteus", "1 imu-garbage", "imu_stale", "",
     "bytes skipped", kDamping, 1, 0.034, 0.034},
    {"foreign-mit", "another program sends a drive set-points, in Walk: MIT layout", "mit",
     "6 foreign RF_HFE 1000", "foreign_traffic", "RF_HFE", "COMMANDS OF ANOTHER PROGRAM", kDamping,
     1, 0.004, 0.004},
    {"foreign-moteus", "another program sends a drive set-points, in Walk: moteus", "moteus",
     "6 foreign RF_HFE 1000", "foreign_traffic", "RF_HFE", "COMMANDS OF ANOTHER PROGRAM", kDamping,
     1, 0.004, 0.004},
    {"second-controller", "a second controller is started in Walk, with another IMU", "mit",
     "6 second", "", "", "expected a silent bus", "walks on; the second refuses, sends nothing", 0,
     0.0, 0.0},
    {"controller-killed", "SIGKILL to the controller in Walk: moteus", "moteus", "6 kill", "", "",
     "", "the drives' time-out damps", -1, 0.052, 0.052},
    {"controller-killed-mit", "SIGKILL to the controller in Walk: MIT layout", "mit", "6 kill", "",
     "", "", "the drives' time-out switches them off", -1, 0.052, 0.052},
    {"bench-dead", "all drives and the IMU are gone", "moteus", "1 dead", "joints_stale",
     "LF_HAA LF_HFE LF_KFE RF_HAA RF_HFE RF_KFE LH_HAA LH_HFE LH_KFE RH_HAA RH_HFE RH_KFE", "",
     "the drives' time-out damps", 1, 0.0, 0.052},
    {"walks-mit", "nothing", "mit", "", "", "", "", "walks", 0, 0.0, 0.0},
    {"walks-damiao", "nothing", "damiao", "", "", "", "", "walks", 0, 0.0, 0.0},
    {"walks-moteus", "nothing", "moteus", "", "", "", "", "walks", 0, 0.0, 0.0},
}};

std::string within(double time_s) {
  return time_s > 0.0 ? fmt::format("{:.0f} ms", 1e3 * time_s) : "-";
}

}  // namespace

std::span<const FaultRun> fault_runs() { return kRuns; }

std::string fault_run_markdown() {
  std::string table =
      "| what goes wrong | fault | joints named | then | drives that hear: damped within | all "
      "drives passive within | exit code |\n|---|---|---|---|---|---|---|\n";
  for (const FaultRun& run : kRuns) {
    if (*run.fault == '\0') continue;
    const bool refused = run.exit_code == 2;
    table +=
        fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", run.what,
                    *run.bit != '\0' ? fmt::format("`{}`", run.bit)
                    : refused        ? "refused at the start"
                                     : "none",
                    run.joints, run.then, within(run.damped_within_s), within(run.passive_within_s),
                    run.exit_code < 0 ? "-" : fmt::format("{}", run.exit_code));
  }
  return table;
}

}  // namespace sandrunner::hil
