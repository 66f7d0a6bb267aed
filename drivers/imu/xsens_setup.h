// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/imu/imu_config.h"
#include "drivers/imu/serial_port.h"
#include "drivers/imu/xsens.h"

namespace sandrunner {

/// Finds an MTi, sets what it sends, compares that with what it grants, and lets it measure; each
/// step is acknowledged. InputError, one line that names the line and the product: an MTi that does
/// not answer, is at another speed than the configured one, or sends something else, or slower,
/// than it was asked for.
///
/// The device keeps its outputs without power, and so its speed, which is therefore left as it is:
/// the command that changes it differs from series to series (SetBaudrate, SetPortConfig), and a
/// wrong one could make the device unreachable for good.
void set_up(SerialPort& port, xsens::Parser& parser, const ImuConfig& config);

}  // namespace sandrunner
