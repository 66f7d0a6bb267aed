// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "rt/report/run_record.h"

namespace sandrunner {

inline constexpr double kRamp_s = 1.0;  // to full speed
inline constexpr double kSpeed_mps = 1.5;
inline constexpr double kStride_s = 0.4;
inline constexpr double kSinkage_m = 0.09;
inline constexpr double kLink_m = 0.24;

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
  for (std::size_t j = 0; j < kNumJoints; ++j) record.scene.joint_names[j] = kJointNames[j];
  for (std::size_t l = 0; l < kNumLegs; ++l) record.scene.leg_names[l] = kLegNames[l];
  record.scene.ground_height_m = [ground](double x, double) { return ground(x); };
  const double end_s = 1.0 + walk_s;
  double x = 0.0;
  std::array<bool, kNumLegs> was_down{};
  for (int i = 0; i <= std::lround((end_s + 0.5) * kPolicyHz); ++i) {
    RunSample s;
    s.t_s = static_cast<double>(i) / kPolicyHz;
    s.has_truth = true;
    const bool walks = s.t_s >= 1.0 && s.t_s <= end_s;
    s.mode = s.t_s < 0.6 ? Mode::kStandUp : walks ? Mode::kWalk : Mode::kStand;
    s.command = {walks ? kSpeed_mps : 0.0, 0.0, walks ? 0.2 : 0.0};
    const double phase = 2.0 * std::numbers::pi * (s.t_s - 1.0) / kStride_s;
    s.vx_mps =
        walks ? std::min(1.0, (s.t_s - 1.0) / kRamp_s) * 1.4 + 0.08 * std::sin(2.0 * phase) : 0.0;
    s.vy_mps = walks ? 0.05 * std::sin(phase) : 0.0;
    s.yaw_rate_radps = walks ? 0.2 + 0.3 * std::sin(phase) : 0.0;
    x += s.vx_mps / kPolicyHz;
    const double pitch = walks ? 0.05 * std::sin(2.0 * phase) : 0.0;
    s.orientation_wxyz = {std::cos(0.5 * pitch), 0.0, std::sin(0.5 * pitch), 0.0};
    s.base_position_m = {x, 0.0, ground(x) + 0.46 - (walks ? sinkage_m : 0.0)};
    s.has_estimate = walks;
    s.truth.velocity_mps = {s.vx_mps, s.vy_mps, 0.0};
    s.truth.body_height_m = s.base_position_m[2] - ground(x);
    s.estimate = s.truth;
    s.estimate.velocity_mps[0] += 0.05 * std::sin(7.0 * s.t_s);
    s.estimate.body_height_m += 0.02 + 0.01 * std::sin(5.0 * s.t_s);
    for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
      const double side = leg % 2 == 0 ? 1.0 : -1.0;
      const double front = leg < 2 ? 1.0 : -1.0;
      const double swing = phase + (side * front > 0.0 ? 0.0 : std::numbers::pi);
      const double lift_m = walks ? 0.09 * std::sin(swing) : 0.0;
      const Vector3 hip = {x + 0.3072 * front, 0.169 * side, s.base_position_m[2] - 0.036};
      Vector3 foot = {hip[0] - (walks ? 0.1 * s.vx_mps * std::cos(swing) : 0.0), hip[1], 0.0};
      const double height = ground(foot[0]);
      const double depth_m = walks ? sinkage_m * std::max(0.0, -std::sin(swing)) : 0.0;
      foot[2] = height + 0.0295 + std::max(0.0, lift_m) - depth_m;
      s.hip_position_m[leg] = hip;
      s.foot_position_m[leg] = foot;
      s.knee_position_m[leg] = knee_of(hip, foot);
      s.ground_height_m[leg] = height;
      s.penetration_m[leg] = lift_m > 0.0 ? -lift_m : depth_m;
      s.contact[leg] = s.penetration_m[leg] >= 0.0;
      if (was_down[leg] && !s.contact[leg] && sinkage_m > 0.0) {
        record.footprints.push_back({s.t_s, foot[0], foot[1], sinkage_m});
      }
      was_down[leg] = s.contact[leg];
      for (std::size_t joint = 0; joint < 3; ++joint) {
        s.joint_torque_nm[3 * leg + joint] =
            walks ? 12.0 * (1.0 + static_cast<double>(joint)) *
                        std::sin(swing + 0.4 * static_cast<double>(joint))
                  : 5.0;
      }
    }
    record.samples.push_back(s);
  }
  return record;
}

inline double flat(double) { return 0.0; }
inline double hilly(double x) { return 0.06 * std::sin(4.0 * x); }

}  // namespace sandrunner
