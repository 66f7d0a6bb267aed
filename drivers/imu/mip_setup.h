// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/imu/imu_config.h"
#include "drivers/imu/mip.h"
#include "drivers/imu/serial_port.h"

namespace sandrunner {

/// Finds a MicroStrain sensor's speed, sets it idle, tells it the configured speed, asks its base
/// rate, sets the message format and turns the stream on; each step is acknowledged. InputError,
/// one line that names the line: an IMU that does not answer, what it refuses, rates that its base
/// rate is no multiple of. Nothing is saved in the device.
void set_up(SerialPort& port, mip::Parser& parser, const ImuConfig& config);

}  // namespace sandrunner
