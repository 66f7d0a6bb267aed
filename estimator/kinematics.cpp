// SPDX-License-Identifier: BSD-3-Clause
#include "estimator/kinematics.h"

#include <algorithm>
#include <limits>

namespace sandrunner {
namespace {

Vector3 moved(const Kinematics::Pose& pose, const Vector3& v) noexcept {
  const Vector3 turned_v = rotated(pose.rotation_wxyz, v);
  return {pose.position_m[0] + turned_v[0], pose.position_m[1] + turned_v[1],
          pose.position_m[2] + turned_v[2]};
}

}  // namespace

std::array<const OutlinePoint*, kNumLegs> feet_of(const RobotDescription& robot) {
  std::array<const OutlinePoint*, kNumLegs> feet{};
  for (int l = 0; l < kNumLegs; ++l) {
    const auto shank =
        std::ranges::find(robot.frames, kJointsPerLeg * (l + 1) - 1, &RobotFrame::joint);
    if (shank == robot.frames.end()) continue;
    const auto hangs_below = [&](std::string link) {
      for (bool below = false;; below = true) {
        const auto frame = std::ranges::find(robot.frames, link, &RobotFrame::name);
        if (frame == robot.frames.end()) return false;
        if (frame->name == shank->name) return below;
        link = frame->parent;
      }
    };
    for (const OutlinePoint& point : robot.outline) {
      if (hangs_below(point.frame)) feet[l] = &point;
    }
  }
  return feet;
}

Kinematics::Kinematics(const RobotDescription& robot) {
  const auto index_of = [this](const std::string& name) {
    const auto found = std::ranges::find(links_, name, [](const Link& l) { return l.frame.name; });
    return found == links_.end() ? -1 : static_cast<int>(found - links_.begin());
  };
  joint_links_.fill(-1);
  for (const RobotFrame& frame : robot.frames) {
    if (frame.joint >= 0) joint_links_[frame.joint] = static_cast<int>(links_.size());
    links_.push_back({index_of(frame.parent), frame});
  }
  for (const OutlinePoint& point : robot.outline) {
    outline_.push_back({index_of(point.frame), point.centre_m, point.radius_m});
  }
  const auto feet = sandrunner::feet_of(robot);
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    feet_[l] = feet[l] ? static_cast<int>(feet[l] - robot.outline.data()) : -1;
  }
  poses_.resize(links_.size());
}

void Kinematics::place(const Pose& base, const JointArray<double>& position_rad) noexcept {
  base_ = base;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const RobotFrame& frame = links_[i].frame;
    const Pose& parent = pose(links_[i].parent);
    const double angle_rad =
        frame.joint < 0 ? 0.0 : position_rad[static_cast<std::size_t>(frame.joint)];
    poses_[i] = {moved(parent, frame.translation_m),
                 product(parent.rotation_wxyz, turned(frame.rotation_wxyz, frame.axis, angle_rad))};
  }
}

Vector3 Kinematics::placed(const Point& point) const noexcept {
  return moved(pose(point.link), point.centre_m);
}

std::array<LegPoints, kNumLegs> Kinematics::legs() const noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto origin = [&](int link) {
    return link < 0 ? Vector3{kNone, kNone, kNone} : pose(link).position_m;
  };
  std::array<LegPoints, kNumLegs> legs;
  for (int l = 0; l < kNumLegs; ++l) {
    const int foot = feet_[static_cast<std::size_t>(l)];
    legs[l] = {
        origin(link_of(kJointsPerLeg * l + 1)), origin(link_of(kJointsPerLeg * l + 2)),
        foot < 0 ? Vector3{kNone, kNone, kNone} : placed(outline_[static_cast<std::size_t>(foot)])};
  }
  return legs;
}

double Kinematics::lowest_m() const noexcept {
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const Point& point : outline_) {
    const double z_m = placed(point)[2] - point.radius_m;
    // Not std::min(): a joint that measures NaN must show in the result.
    if (!(z_m >= lowest_m)) lowest_m = z_m;
  }
  return lowest_m;
}

}  // namespace sandrunner
