// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/imu_judge.h"

#include <algorithm>
#include <cmath>

#include "rt/core/faults.h"
#include "rt/core/joint_pd.h"
#include "rt/core/rotation.h"
#include "rt/core/same_bits.h"

namespace sandrunner {
namespace {

bool within(const Vector3& v, double range) noexcept {
  return std::ranges::all_of(v, [&](double value) { return std::fabs(value) <= range; });
}

double squared(const Vector3& v) noexcept { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// The turn from one attitude to the next, body frame, rad: for small ones its vector, for large
/// ones less than that, but never small.
Vector3 turn_between(const Rotation& from, const Rotation& to) noexcept {
  const Rotation step = product(inverse(from), to);
  const double scale = step[0] < 0.0 ? -2.0 : 2.0;
  return {scale * step[1], scale * step[2], scale * step[3]};
}

/// Follows the error of the attitude, as two angles about the world's x and y: it grows by what the
/// attitude turns and the gyroscope does not, and goes towards the angle at which the mean specific
/// force stands away from the vertical. So drifts of any speed add up. What lasts without such an
/// angle is an offset of the gyroscope. (A Luenberger observer of both, critically damped.)
void follow_tilt_error(const std::array<Vector3, 3>& axes, const Vector3& excess_rad, double felt,
                       double step_s, double compare_s, ImuMemory& memory) noexcept {
  const double rate = 1.0 / compare_s;
  const Vector3& felt_mps2 = memory.felt_mps2;
  const double per_felt = 1.0 / felt, mean_share = std::min(step_s * (1.0 / kTiltMean_s), 1.0);
  const std::array<double, 2> leans_rad = {-felt_mps2[1] * per_felt, felt_mps2[0] * per_felt};
  Vector3& offset_radps = memory.gyro_offset_radps;
  Vector3 turned_rad;
  for (int i = 0; i < 3; ++i) turned_rad[i] = excess_rad[i] + step_s * offset_radps[i];
  turned_rad = to_world(axes, turned_rad);
  std::array<double, 2> miss_rad;
  for (int i = 0; i < 2; ++i) {
    double& error_rad = memory.tilt_error_rad[i];
    miss_rad[i] = leans_rad[i] - error_rad;
    error_rad += turned_rad[i] + step_s * 2.0 * rate * miss_rad[i];
    double& mean_rad = memory.mean_error_rad[i];
    mean_rad += mean_share * (error_rad - mean_rad);
  }
  for (int i = 0; i < 3; ++i) {
    const double body_rad = axes[i][0] * miss_rad[0] + axes[i][1] * miss_rad[1];
    offset_radps[i] = clamp_to(offset_radps[i] + step_s * rate * rate * body_rad,
                               -kGyroOffset_radps, kGyroOffset_radps);
  }
}

}  // namespace

std::uint64_t judge_imu(const GateConfig& config, const ImuSample& imu, bool comparing,
                        ImuMemory& memory) noexcept {
  std::uint64_t found = 0;
  if (!within(imu.angular_velocity_radps, kGyroRange_radps) ||
      !within(imu.linear_acceleration_mps2, kAccelerometerRange_mps2)) {
    found |= fault_bit(Fault::kImuRange);
  }
  const ImuSample before = memory.sample;
  const bool first = memory.seen == 0;
  if (!first && imu.tick <= before.tick) return found;  // no new sample
  memory.seen = 1;
  memory.sample = imu;
  if (first) return found;
  if (!comparing) {
    memory.same_samples.fill(0);
    memory.lean_ticks = 0;
    memory.turn_error_rad = {};
  }

  const bool same[] = {same_bits(imu.orientation_wxyz, before.orientation_wxyz),
                       same_bits(imu.angular_velocity_radps, before.angular_velocity_radps),
                       same_bits(imu.linear_acceleration_mps2, before.linear_acceleration_mps2)};
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t repeats = i == 0 ? 2 * (config.imu_attitude_samples - 1) : 0;
    std::uint64_t& count = memory.same_samples[i];
    count = same[i] && comparing ? count + 1 : 0;
    if (count >= kImuFrozenSamples + repeats) found |= fault_bit(Fault::kImuFrozen);
  }

  const std::uint64_t ticks = imu.tick - before.tick;
  // A longer gap is a stall of the loop, through which nothing is known of the motion.
  if (ticks > std::max(config.imu_fault_ticks, kShortestImuGap_ticks)) return found;
  const double step_s = kControlPeriod_s * static_cast<double>(ticks);
  const double share = std::min(step_s / kImuCompare_s, 1.0);
  const Vector3 turned_rad = turn_between(before.orientation_wxyz, imu.orientation_wxyz);
  const std::array<Vector3, 3> axes = body_axes(imu.orientation_wxyz);
  const Vector3 felt_mps2 = to_world(axes, imu.linear_acceleration_mps2);
  Vector3 excess_rad;
  for (int i = 0; i < 3; ++i) {
    const double rate_radps =
        0.5 * (before.angular_velocity_radps[i] + imu.angular_velocity_radps[i]);
    excess_rad[i] = turned_rad[i] - step_s * rate_radps;
    double& error_rad = memory.turn_error_rad[i];
    error_rad += excess_rad[i] - share * error_rad;
    memory.felt_mps2[i] += share * (felt_mps2[i] - memory.felt_mps2[i]);
  }
  if (comparing && squared(memory.turn_error_rad) > kGyroDisagrees_rad * kGyroDisagrees_rad) {
    found |= fault_bit(Fault::kImuGyro);
  }
  // Falling there is no direction to judge, and a fall is another fault.
  const double felt = std::sqrt(squared(memory.felt_mps2));
  const bool falls = felt <= 0.5 * kGravity_mps2;
  if (!comparing) memory.rest_s = std::min(memory.rest_s + step_s, kTiltRest_s);
  const double compare_s = comparing ? kTiltCompare_s : memory.rest_s;
  if (!falls) follow_tilt_error(axes, excess_rad, felt, step_s, compare_s, memory);
  const bool leans = comparing && !falls && memory.felt_mps2[2] < kLeanCosine * felt;
  memory.lean_ticks = leans ? memory.lean_ticks + ticks : 0;
  const auto& [x_rad, y_rad] = memory.mean_error_rad;
  const bool drifts =
      comparing && x_rad * x_rad + y_rad * y_rad > kTiltDisagrees_rad * kTiltDisagrees_rad;
  if (drifts || memory.lean_ticks > ticks_from_s(kLean_s)) {
    found |= fault_bit(Fault::kImuAttitude);
  }
  return found;
}

}  // namespace sandrunner
