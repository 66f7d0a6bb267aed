// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/imu_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sandrunner {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kMostTilt_rad = 20.0 * kDegree_rad;
constexpr double kMostAttitudeError_rad = 10.0 * kDegree_rad;
constexpr double kMostGravityError_mps2 = 0.5;
constexpr double kMostBias_radps = 0.05;
constexpr double kLeastRate = 0.95;

double angle(const Vector3& a, const Vector3& b) {
  const double lengths = length(a) * length(b);
  if (lengths == 0.0) return 0.0;
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return std::acos(std::clamp(dot / lengths, -1.0, 1.0));
}

}  // namespace

void ImuLook::add(const ImuSample& sample) {
  ++samples_;
  const auto& [w, x, y, z] = sample.orientation_wxyz;
  const Vector3 up{2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z};
  for (int i = 0; i < 3; ++i) {
    acceleration_[i] += sample.linear_acceleration_mps2[i];
    angular_velocity_[i] += sample.angular_velocity_radps[i];
    up_[i] += up[i];
  }
}

ImuFigures ImuLook::figures(std::uint64_t streamed, double duration_s) const {
  ImuFigures f;
  f.samples = samples_;
  f.rate_hz = duration_s > 0.0 ? static_cast<double>(streamed) / duration_s : 0.0;
  if (samples_ == 0) return f;
  for (int i = 0; i < 3; ++i) {
    f.acceleration_mps2[i] = acceleration_[i] / samples_;
    f.angular_velocity_radps[i] = angular_velocity_[i] / samples_;
  }
  f.tilt_rad = angle(f.acceleration_mps2, {0.0, 0.0, 1.0});
  f.attitude_error_rad = angle(f.acceleration_mps2, up_);
  return f;
}

std::vector<std::string> imu_problems(const ImuFigures& f, double rate_hz) {
  if (f.samples == 0) return {"no sample came"};
  std::vector<std::string> problems;
  if (f.rate_hz < kLeastRate * rate_hz) {
    problems.push_back(
        fmt::format("{:.0f} samples/s came of {:.0f}: look at the line's speed and its converter",
                    f.rate_hz, rate_hz));
  }
  const double gravity_mps2 = length(f.acceleration_mps2);
  if (std::fabs(gravity_mps2 - kGravity_mps2) > kMostGravityError_mps2) {
    problems.push_back(fmt::format(
        "measures {:.2f} m/s^2 at rest, expected {:.2f}: it moves, or is no such sensor",
        gravity_mps2, kGravity_mps2));
  }
  if (f.tilt_rad > kMostTilt_rad) {
    problems.push_back(
        fmt::format("up is {:.0f} degrees from the body's z axis, at ({:.2f}, {:.2f}, {:.2f}) "
                    "m/s^2: stand the robot level, or look at hardware.imu.mounting_rpy_deg",
                    f.tilt_rad / kDegree_rad, f.acceleration_mps2[0], f.acceleration_mps2[1],
                    f.acceleration_mps2[2]));
  }
  if (f.attitude_error_rad > kMostAttitudeError_rad) {
    problems.push_back(
        fmt::format("its attitude and its acceleration differ by {:.0f} degrees about where up is: "
                    "its filter has not settled, or has a mounting of its own",
                    f.attitude_error_rad / kDegree_rad));
  }
  const double bias_radps = length(f.angular_velocity_radps);
  if (bias_radps > kMostBias_radps) {
    problems.push_back(fmt::format(
        "turns by {:.3f} rad/s at rest: it moves, or its bias wants calibrating", bias_radps));
  }
  return problems;
}

FrontLift judge_front_lift(const Vector3& level_mps2, const Vector3& lifted_mps2) {
  constexpr double kLeastTilt_deg = 8.0, kMostTurn_deg = 30.0;
  constexpr const char* kSides[] = {"front", "left side", "back", "right side"};
  const double tilt_deg = angle(level_mps2, lifted_mps2) / kDegree_rad;
  if (tilt_deg < kLeastTilt_deg) {
    return {.words = fmt::format("front lifted by {:.0f} degrees where about {:.0f} were asked for",
                                 tilt_deg, kAskedTilt_deg)};
  }
  // Up leans towards the side that was lifted.
  const double turn_deg =
      std::atan2(lifted_mps2[1] / length(lifted_mps2) - level_mps2[1] / length(level_mps2),
                 lifted_mps2[0] / length(lifted_mps2) - level_mps2[0] / length(level_mps2)) /
      kDegree_rad;
  if (std::fabs(turn_deg) <= kMostTurn_deg) {
    return {true, fmt::format("front lifted by {:.0f} degrees, as it should", tilt_deg)};
  }
  const auto side = static_cast<std::size_t>(std::lround(turn_deg / 90.0) + 4) % 4;
  return {.words =
              fmt::format("its readings show the {} lifted, not the front, {:.0f} degrees off: "
                          "look at hardware.imu.mounting_rpy_deg, at its yaw first",
                          kSides[side], std::fabs(turn_deg))};
}

}  // namespace sandrunner
