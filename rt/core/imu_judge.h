// SPDX-License-Identifier: BSD-3-Clause
// Whether an IMU can be believed: its values change, are ones that it can measure, and agree with
// each other. A robot that is fed a wrong attitude runs on its back without any other sign of it.
#pragma once

#include <cstdint>

#include "rt/core/gate_config.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Samples in a row with the same bits in the attitude, the angular velocity or the acceleration
/// after which the IMU counts as frozen. A real one has noise in every sample. An attitude that is
/// sent less often (imu_attitude_samples) may be missed once more.
inline constexpr std::uint64_t kImuFrozenSamples = 10;

// Beyond what an IMU of a legged robot can measure lies an error of unit or of transport.
// Gyroscopes end at 2,000 degrees/s (35 rad/s). Accelerometers end at 40 g, but a simulated body
// that meets hard ground is stopped in one step, at up to 1,700 m/s^2.
inline constexpr double kGyroRange_radps = 40.0;
inline constexpr double kAccelerometerRange_mps2 = 1e4;

/// Time constant of the comparisons below: longer than a stride, shorter than a fall.
inline constexpr double kImuCompare_s = 0.5;
/// Fault: the attitude's own change and the angular velocity disagree by this much, rad.
inline constexpr double kGyroDisagrees_rad = 0.2;
/// Fault: the direction of the mean specific force in the world is this far from vertical ...
inline constexpr double kLeanCosine = 0.8660254037844386;  ///< cos 30 degrees
inline constexpr double kLean_s = 0.5;                     ///< ... for this long
/// Fault: gyroscope and accelerometer together say that the attitude's vertical is wrong by this
/// much, rad (11 degrees). A policy still walks with 13, and on sand falls over from 14 on. A turn
/// or a start at the limit of acceleration counts as 0.1 rad.
inline constexpr double kTiltDisagrees_rad = 0.19;
/// Time in which the accelerometer corrects what the gyroscope says of that. Of a robot at rest it
/// is the time since the start between the other two: it knows the offset of its gyroscope when it
/// stands up.
inline constexpr double kTiltCompare_s = 8.0, kTiltRestFirst_s = 0.5, kTiltRest_s = 2.0;
inline constexpr double kTiltMean_s = 0.05;
/// No gyroscope has a larger offset.
inline constexpr double kGyroOffset_radps = 0.1;
/// A gap between two samples that is longer than this, and longer than imu_fault_ticks, is a stall
/// of the loop.
inline constexpr std::uint64_t kShortestImuGap_ticks = kTicksPerPolicyStep;

/// What is remembered of the IMU. All members 64 bits wide.
struct ImuMemory {
  std::uint64_t seen = 0;  ///< 1: `sample` is the latest one that was judged
  ImuSample sample;
  std::array<std::uint64_t, 3> same_samples{};  ///< in a row: attitude, gyroscope, accelerometer
  std::uint64_t lean_ticks = 0;
  Vector3 turn_error_rad{};  ///< of the attitude's change, less the angular velocity's integral
  Vector3 felt_mps2{0.0, 0.0, kGravity_mps2};  ///< specific force in the world, low-passed
  std::array<double, 2> tilt_error_rad{};      ///< of the attitude, about the world's x and y
  std::array<double, 2> mean_error_rad{};      ///< the same, low-passed: attitudes have noise
  Vector3 gyro_offset_radps{};                 ///< learnt with it
  double rest_s = kTiltRestFirst_s;            ///< time in which a robot at rest is corrected
};
static_assert(sizeof(ImuMemory) == 8 * (1 + 11 + 3 + 1 + 3 + 3 + 4 + 3 + 1), "no padding");

/// Judges a usable sample (finite, unit quaternion) and remembers it; the bits of the faults
/// kImuFrozen, kImuRange, kImuAttitude and kImuGyro that it shows, whatever the mode. The same
/// sample may be given any number of times. Not `comparing`: the robot does not carry itself, and
/// only what needs no past is judged.
std::uint64_t judge_imu(const GateConfig& config, const ImuSample& imu, bool comparing,
                        ImuMemory& memory) noexcept;

}  // namespace sandrunner
