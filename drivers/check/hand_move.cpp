// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/hand_move.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "estimator/kinematics.h"
#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

constexpr double kShortestLever_m = 1e-3;
constexpr double kLeastMove_rad = 0.05;
// A gear is wrong by 2 more often than by less; a hand finds 30 degrees better than that.
constexpr double kMostFactor = 1.5;

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::string direction_words(const Vector3& v) {
  constexpr std::array<std::array<const char*, 2>, 3> kWords = {
      {{"forward", "backward"}, {"to the left", "to the right"}, {"up", "down"}}};
  std::string words;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::fabs(v[axis]) < 0.5 * length(v)) continue;
    words += (words.empty() ? "" : " and ") + std::string(kWords[axis][v[axis] < 0.0 ? 1 : 0]);
  }
  return words;
}

}  // namespace

std::string positive_motion(const RobotDescription& robot, const JointArray<double>& pose_rad,
                            int joint) {
  Kinematics kinematics(robot);
  kinematics.place({}, pose_rad);
  const int link = kinematics.link_of(joint);
  if (link < 0) return "";
  const Kinematics::Pose& pivot = kinematics.pose(link);
  const Vector3 axis = rotated(pivot.rotation_wxyz, robot.frames[link].axis);
  std::string part = robot.frames[link].name;
  Vector3 fastest{};
  std::vector<bool> moved(robot.frames.size());  // by the joint in question
  for (int i = 0; i < static_cast<int>(robot.frames.size()); ++i) {
    const int parent = kinematics.parent(i);
    moved[i] = i == link || (parent >= 0 && moved[parent]);
    if (!moved[i]) continue;
    const Vector3& origin_m = kinematics.pose(i).position_m;
    const Vector3 lever{origin_m[0] - pivot.position_m[0], origin_m[1] - pivot.position_m[1],
                        origin_m[2] - pivot.position_m[2]};
    const Vector3 velocity = cross(axis, lever);
    if (length(velocity) <= length(fastest)) continue;
    fastest = velocity;
    part = robot.frames[i].name;
  }
  if (length(fastest) < kShortestLever_m) {
    return fmt::format("{} turns right-handed about ({:.2f}, {:.2f}, {:.2f})", part, axis[0],
                       axis[1], axis[2]);
  }
  return fmt::format("{} goes {}", part, direction_words(fastest));
}

HandMove judge_move(const JointTrace& trace, int joint) {
  HandMove move{.joint = joint};
  if (trace.empty()) return move;
  double widest_rad = 0.0;
  for (int j = 0; j < kNumJoints; ++j) {
    const auto [least, most] = std::minmax_element(
        trace.begin(), trace.end(), [j](const auto& a, const auto& b) { return a[j] < b[j]; });
    const double width_rad = (*most)[j] - (*least)[j];
    if (width_rad <= widest_rad) continue;
    widest_rad = width_rad;
    move.joint = j;
  }
  move.moved_rad = trace.back()[move.joint] - trace.front()[move.joint];
  if (widest_rad < kLeastMove_rad) {
    move.verdict = HandMove::Verdict::kNotMoved;
  } else if (move.joint != joint) {
    move.verdict = HandMove::Verdict::kOtherJoint;
  } else if (std::fabs(move.moved_rad) < kAsked_rad / kMostFactor ||
             std::fabs(move.moved_rad) > kAsked_rad * kMostFactor) {
    move.verdict = HandMove::Verdict::kWrongScale;
  } else {
    move.verdict = move.moved_rad > 0.0 ? HandMove::Verdict::kGood : HandMove::Verdict::kWrongSign;
  }
  return move;
}

std::string move_words(const HandMove& move, int joint, const HardwareConfig& config,
                       const RobotDescription& robot) {
  const auto name_of = [&](int j) { return drive_name(config, robot, j); };
  const std::string name = name_of(joint);
  switch (move.verdict) {
    case HandMove::Verdict::kGood:
      return fmt::format("{}: turned by {:.2f} rad, as it should", name, move.moved_rad);
    case HandMove::Verdict::kNotMoved:
      return fmt::format("{}: no drive turned; does its motor turn with the joint?", name);
    case HandMove::Verdict::kOtherJoint:
      return fmt::format("{}: the drive of {} turned, by {:.2f} rad: swap them in the file", name,
                         name_of(move.joint), move.moved_rad);
    case HandMove::Verdict::kWrongSign:
      return fmt::format("{}: turned by {:.2f} rad, the other way: set sign = {}", name,
                         move.moved_rad, -config.drives[joint].sign);
    case HandMove::Verdict::kWrongScale:
      break;
  }
  return fmt::format(
      "{}: turned by {:.2f} rad where about {:.1f} were asked for: turn it once more, or look at "
      "gear and model",
      name, move.moved_rad, kAsked_rad);
}

}  // namespace sandrunner
