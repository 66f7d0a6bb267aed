// SPDX-License-Identifier: BSD-3-Clause
// What creeps up on a robot: conditions that leave it the time to lie down. A robot that walks at
// 2.5 m/s and is damped at once meets the ground at 2.7 m/s; one that stops and lies down, at 0.4.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace sandrunner {

/// Reasons to stop, stand and lie down, as bits. Each has a second limit, which is a fault.
enum class Warning : std::uint64_t {
  kNone = 0,
  kDriveWarning = 1u << 0,
  kHeating = 1u << 1,
  kImuLate = 1u << 2,
  kLeaning = 1u << 3,
  kLifted = 1u << 4,
};
inline constexpr int kNumWarnings = 5;

constexpr std::uint64_t warning_bit(Warning warning) noexcept {
  return static_cast<std::uint64_t>(warning);
}

struct WarningRow {
  Warning warning;
  const char* name;
  const char* meaning;  ///< the first limit
  const char* second;   ///< the second limit, and the fault that it is
};

inline constexpr std::array<WarningRow, kNumWarnings> kWarningTable = {{
    {Warning::kDriveWarning, "drive_warning",
     "a drive or motor is above `hardware.temperature_limit_degc`, its supply is outside "
     "`hardware.voltage_low_v` to `.voltage_high_v`, or the battery is below "
     "`hardware.unitree.low_battery_percent`",
     "10 degrees C above, 5 % outside, half of it: `drive_fault`"},
    {Warning::kHeating, "heating",
     "the mean of a joint's squared torque is above 0.9 of what its drive can give for long (I2t)",
     "above all of it: `overload`"},
    {Warning::kImuLate, "imu_late", "the IMU's sample is older than 10 ms",
     "older than 30 ms: `imu_stale`"},
    {Warning::kLeaning, "leaning",
     "in Stand the body has leaned for half a second by 3.5 degrees from how it came to stand: the "
     "ground gives way",
     "past 45 and 60 degrees: `tilt`"},
    {Warning::kLifted, "lifted",
     "in Walk the knees have given less than 0.15 of what they gave in Stand for half a second: "
     "the robot is held up",
     "released: `free_fall`, `tilt`"},
}};

// From the first limit to the second: time to stop and to lie down.
inline constexpr double kTooHot_degc = 10.0;
inline constexpr double kVoltageShare = 0.05;
inline constexpr double kBatteryShare = 0.5;

constexpr bool warnings_in_order() noexcept {
  for (int i = 0; i < kNumWarnings; ++i) {
    if (warning_bit(kWarningTable[i].warning) != std::uint64_t{1} << i) return false;
  }
  return true;
}
static_assert(warnings_in_order());

/// Stable name of the lowest of these bits: "drive_warning", "heating", "imu_late", "leaning",
/// "lifted"; "none".
constexpr const char* warning_name(std::uint64_t warnings) noexcept {
  const int bit = std::countr_zero(warnings);
  return bit < kNumWarnings ? kWarningTable[bit].name : "none";
}

}  // namespace sandrunner
