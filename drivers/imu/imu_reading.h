// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/imu/mip.h"
#include "drivers/imu/xsens.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// What a MicroStrain accelerometer calls 1 g (3DM-GX5 DCP manual, "Scaled Accelerometer Vector").
inline constexpr double kStandardGravity_mps2 = 9.80665;

/// What a packet of a sensor holds, whatever its protocol: in the sensor's axes, x forward, y left,
/// z up (FLU), and its world, north, west, up (NWU).
struct ImuReading {
  std::optional<std::uint64_t> device_ns;    ///< device's clock when it was taken
  std::optional<Vector3> acceleration_mps2;  ///< specific force: +9.81 in z, level and at rest
  std::optional<Vector3> angular_velocity_radps;
  std::optional<std::array<double, 4>> orientation_wxyz;  ///< from sensor to world
  bool operator==(const ImuReading&) const = default;
};

/// MIP's axes are those of FRD and NED: both are half a turn about x away. Accelerations are in g.
ImuReading to_reading(const mip::SensorData& data) noexcept;
/// Xsens' are these axes already: of the worlds that a device can be asked for (ENU, NED, NWU) the
/// driver asks for this one. Its time goes round: without `device_ns`, which is the caller's.
ImuReading to_reading(const xsens::SensorData& data) noexcept;

/// The ways back, for what plays a sensor.
mip::SensorData to_mip(const ImuReading& reading) noexcept;
xsens::SensorData to_xsens(const ImuReading& reading) noexcept;

}  // namespace sandrunner
