// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/can/bus_load.h"
#include "drivers/imu/imu_config.h"
#include "drivers/robot/drive_families.h"
#include "drivers/robot/emergency_stop.h"
#include "rt/base/config_tree.h"
#include "rt/base/settings.h"
#include "rt/core/gate_config.h"
#include "rt/core/messages.h"
#include "rt/core/robot_description.h"

namespace sandrunner {

/// Where the joint's loop is closed.
enum class DriveMode : std::uint8_t {
  kGains,  ///< the drive, by the whole JointCommand
  kTorque  ///< the host: drives get a torque
};

/// One CAN bus. The bit rates are the interface's own (`ip link`); here they serve the plan of its
/// load.
struct BusConfig {
  std::string interface;
  AnyDrive any_drive;  ///< of the family that the bus carries, its settings not read
  CanFormat format = CanFormat::kClassic;
  BusRates rates;
};

/// One drive and the joint that it moves: joint = sign x drive / gear + zero, torques and gains
/// accordingly.
struct DriveConfig {
  int bus = 0;  ///< index into HardwareConfig::buses
  AnyDrive drive;
  double max_torque_nm = 0.0;  ///< largest torque of a command, at its output
  int sign = 1;
  double gear = 1.0;             ///< turns of the drive's output for one of the joint
  double zero_rad = 0.0;         ///< joint's position where the drive's is zero
  double reported_torque = 1.0;  ///< the torque that it reports over the one that it gives

  int id() const noexcept {
    return std::visit([](const auto& d) { return drive_id(d); }, drive);
  }
  DriveRanges ranges() const noexcept {
    return std::visit([](const auto& d) { return drive_ranges(d); }, drive);
  }
  /// Speed of the fastest joint that the drive's replies can report.
  double reply_speed_radps() const noexcept { return ranges().velocity_radps / gear; }
};

/// Table [hardware]: the drives of a robot, which joint each moves, and its IMU.
struct HardwareConfig {
  DriveMode mode = DriveMode::kGains;
  int rate_hz = 1000;               ///< of the exchange with every drive; divides the control rate
  double drive_timeout_s = 0.05;    ///< a drive without commands for this long gives no torque
  bool timeout_unverified = false;  ///< the user set it in drives that cannot report it
  double temperature_limit_degc = 80.0;              ///< a hotter drive is a warning
  double voltage_low_v = 0.0, voltage_high_v = 1e3;  ///< a supply outside is a warning
  double torque_scale = 1.0;                         ///< of every torque limit, for first walks
  bool hanging = false;  ///< the robot hangs in a frame: falls and tilts are not judged
  std::vector<BusConfig> buses;
  JointArray<DriveConfig> drives;
  ImuConfig imu;
  StopLineConfig emergency_stop;

  int ticks_per_exchange() const noexcept { return kControlHz / rate_hz; }
};

/// Reads the tables [hardware], [[hardware.bus]], [[hardware.drive]], [hardware.imu],
/// [hardware.emergency_stop]. Drives are named by the joints of `robot`, each exactly once. Throws
/// InputError for a joint without a drive or with two, for two drives with one identifier, and for
/// an unknown protocol or model; for a rate that does not divide the control rate; for a drive
/// whose range is below the limits of `gate` (torque, speed, positions, gains).
HardwareConfig read_hardware_config(ConfigTree& config, const RobotDescription& robot,
                                    const GateConfig& gate);
/// The keys of these tables, for the reference.
std::vector<SettingLine> hardware_settings();

/// "LF_HAA (can0 id 1)": the name of a joint's drive in messages.
std::string drive_name(const HardwareConfig& hardware, const RobotDescription& robot, int joint);

}  // namespace sandrunner
