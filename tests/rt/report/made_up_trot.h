// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "rt/report/run_record.h"
#include "tests/support/joint_names.h"

namespace sandrunner {

inline constexpr double kRamp_s = 1.0;  // to full speed
inline constexpr float kSpeed_mps = 1.5f;
inline constexpr double kStride_s = 0.4;
inline constexpr double kSinkage_m = 0.09;
inline constexpr double kLink_m = 0.24;

inline std::array<float, 3> floats(double a, double b, double c) {
  return {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
}

/// Knee of a leg of two equal links, behind the line from hip to foot.
inline Vector3 knee_of(const Vector3& hip, const Vector3& foot) {
  const double dx = foot[0] - hip[0];
  const double dz = foot[2] - hip[2];
  const double length = std::hypot(dx, dz);
  const double off = std::sqrt(std::max(0.0, kLink_m * kLink_m - 0.25 * length * length));
  return {hip[0] + 0.5 * dx + off * dz / length, hip[1], hip[2] + 0.5 * dz - off * dx / length};
}

/// A made-up trot: stands for a second, runs for `walk_s`, stands again. Ground of height
/// `ground(x)`.
inline RunRecord trot(double walk_s, double (*ground)(double), double sinkage_m) {
  RunRecord record;
  record.scene.terrain = "dry-sand";
  record.scene.policy = "made-up";
  record.scene.granular_ground = sinkage_m > 0.0;
  record.scene.base_box_size_m = {0.7, 0.28, 0.12};
  record.scene.foot_radius_m = 0.03;
  for (std::size_t j = 0; j < kNumJoints; ++j) record.scene.robot.joint_names[j] = kJointNames[j];
  for (std::size_t l = 0; l < kNumLegs; ++l) record.scene.robot.leg_names[l] = kLegNames[l];
  record.scene.ground_height_m = [ground](double x, double) { return ground(x); };
  const double end_s = 1.0 + walk_s;
  double x = 0.0;
  std::array<bool, kNumLegs> was_down{};
  for (int i = 0; i <= std::lround((end_s + 0.5) * kPolicyHz); ++i) {
    RunRow row;
    row.t_s = static_cast<double>(i) / kPolicyHz;
    const bool walks = row.t_s >= 1.0 && row.t_s <= end_s;
    row.mode = static_cast<std::uint32_t>(row.t_s < 0.6 ? Mode::kStandUp
                                          : walks       ? Mode::kWalk
                                                        : Mode::kStand);
    row.given = {walks ? kSpeed_mps : 0.0f, 0.0f, walks ? 0.2f : 0.0f};
    const double phase = 2.0 * std::numbers::pi * (row.t_s - 1.0) / kStride_s;
    const double vx_mps =
        walks ? std::min(1.0, (row.t_s - 1.0) / kRamp_s) * 1.4 + 0.08 * std::sin(2.0 * phase) : 0.0;
    const double vy_mps = walks ? 0.05 * std::sin(phase) : 0.0;
    const double yaw_rate_radps = walks ? 0.2 + 0.3 * std::sin(phase) : 0.0;
    row.motion = floats(vx_mps, vy_mps, yaw_rate_radps);
    x += vx_mps / kPolicyHz;
    const double pitch = walks ? 0.05 * std::sin(2.0 * phase) : 0.0;
    row.orientation_wxyz = {static_cast<float>(std::cos(0.5 * pitch)), 0.0f,
                            static_cast<float>(std::sin(0.5 * pitch)), 0.0f};
    row.position_m = {x, 0.0, ground(x) + 0.46 - (walks ? sinkage_m : 0.0)};
    row.flags = kRowHasTruth | (walks ? kRowHasEstimate : 0);
    row.truth[0] = static_cast<float>(row.position_m[2] - ground(x));
    row.truth[1] = row.motion[0];
    row.truth[2] = row.motion[1];
    row.estimate = row.truth;
    row.estimate[0] += static_cast<float>(0.02 + 0.01 * std::sin(5.0 * row.t_s));
    row.estimate[1] += static_cast<float>(0.05 * std::sin(7.0 * row.t_s));
    if (!walks) row.estimate.fill(std::numeric_limits<float>::quiet_NaN());
    for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
      const double side = leg % 2 == 0 ? 1.0 : -1.0;
      const double front = leg < 2 ? 1.0 : -1.0;
      const double swing = phase + (side * front > 0.0 ? 0.0 : std::numbers::pi);
      const double lift_m = walks ? 0.09 * std::sin(swing) : 0.0;
      const Vector3 hip = {x + 0.3072 * front, 0.169 * side, row.position_m[2] - 0.036};
      Vector3 foot = {hip[0] - (walks ? 0.1 * vx_mps * std::cos(swing) : 0.0), hip[1], 0.0};
      const double height = ground(foot[0]);
      const double depth_m = walks ? sinkage_m * std::max(0.0, -std::sin(swing)) : 0.0;
      foot[2] = height + 0.0295 + std::max(0.0, lift_m) - depth_m;
      const Vector3 knee = knee_of(hip, foot);
      row.hip_m[leg] = floats(hip[0], hip[1], hip[2]);
      row.foot_m[leg] = floats(foot[0], foot[1], foot[2]);
      row.knee_m[leg] = floats(knee[0], knee[1], knee[2]);
      row.ground_height_m[leg] = static_cast<float>(height);
      row.penetration_m[leg] = static_cast<float>(lift_m > 0.0 ? -lift_m : depth_m);
      const bool down = row.penetration_m[leg] >= 0.0f;
      row.contact[leg] = down ? 1.0f : 0.0f;
      if (was_down[leg] && !down && sinkage_m > 0.0) {
        record.footprints.push_back({row.t_s, foot[0], foot[1], static_cast<float>(sinkage_m)});
      }
      was_down[leg] = down;
      for (std::size_t joint = 0; joint < 3; ++joint) {
        row.torque_nm[3 * leg + joint] =
            static_cast<float>(walks ? 12.0 * (1.0 + static_cast<double>(joint)) *
                                           std::sin(swing + 0.4 * static_cast<double>(joint))
                                     : 5.0);
      }
    }
    record.rows.push_back(row);
  }
  return record;
}

inline double flat(double) { return 0.0; }
inline double hilly(double x) { return 0.06 * std::sin(4.0 * x); }

}  // namespace sandrunner
