// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/check/bus_scan.h"
#include "drivers/check/imu_look.h"
#include "drivers/imu/imu.h"
#include "drivers/robot/drive_look.h"
#include "drivers/robot/hardware_config.h"

namespace sandrunner {

/// The observed behaviour of the IMU.
struct ImuFindings {
  ImuFigures figures;
  std::string state;              ///< to_string(Imu::State)
  std::uint64_t bad_packets = 0;  ///< with a bad checksum, repeated, incomplete
};

/// Everything that the check found.
struct CheckFindings {
  std::vector<std::vector<ScannedDrive>> scanned;  ///< by bus; empty: not scanned
  JointArray<FoundDrive> drives;
  std::optional<ImuFindings> imu;     ///< none: it could not be set up
  std::string emergency_stop;         ///< the state of its switch
  std::vector<std::string> moves;     ///< the result of each joint turned by hand, a line each
  std::vector<std::string> nudges;    ///< the result of each joint pushed by its drive, a line each
  bool powered = false;               ///< drives were enabled
  std::vector<std::string> problems;  ///< a line each
};

/// Lines about scanned drives that the configuration does not expect there: an id that no joint
/// has, a reply with another identifier.
std::vector<std::string> scan_problems(const HardwareConfig& config, const RobotDescription& robot,
                                       const std::vector<std::vector<ScannedDrive>>& scanned);

/// Lines about other events on a bus than replies.
std::vector<std::string> bus_problems(const HardwareConfig& config,
                                      const std::vector<FoundBus>& buses);

/// Lines about the IMU.
std::vector<std::string> imu_problems(const ImuConfig& config, const ImuFindings& findings);

/// One line per joint: its drive's answers and its position.
std::string joint_table(const HardwareConfig& config, const RobotDescription& robot,
                        const GateConfig& gate, const JointArray<FoundDrive>& drives);
std::string imu_line(const ImuConfig& config, const ImuFindings& findings);

/// The report as text.
std::string check_report(const HardwareConfig& config, const RobotDescription& robot,
                         const GateConfig& gate, const CheckFindings& findings);

}  // namespace sandrunner
