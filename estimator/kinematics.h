// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "rt/core/robot_description.h"
#include "rt/core/rotation.h"

namespace sandrunner {

/// Points of a leg, m.
struct LegPoints {
  Vector3 hip{};   ///< origin of the second joint (HFE)
  Vector3 knee{};  ///< origin of the third joint (KFE)
  Vector3 foot{};  ///< centre of the foot
};

/// The foot of each leg: the outline's point that hangs below the link of the leg's last joint, but
/// not on that link itself (the outline has the knee there). Null: the description has none.
std::array<const OutlinePoint*, kNumLegs> feet_of(const RobotDescription& robot);

/// Forward kinematics: where the links of a robot are. No heap after construction.
class Kinematics {
 public:
  struct Pose {
    Vector3 position_m{};
    Rotation rotation_wxyz{1.0, 0.0, 0.0, 0.0};
  };

  explicit Kinematics(const RobotDescription& robot);

  /// Places all links. All results are in the frame in which the pose of the base is given.
  void place(const Pose& base, const JointArray<double>& position_rad) noexcept;

  /// Index of the link that this joint turns; -1: there is none.
  int link_of(int joint) const noexcept { return joint_links_[static_cast<std::size_t>(joint)]; }
  /// Index of a link in RobotDescription::frames; -1: the base frame.
  int parent(int link) const noexcept { return links_[static_cast<std::size_t>(link)].parent; }
  const Pose& pose(int link) const noexcept {
    return link < 0 ? base_ : poses_[static_cast<std::size_t>(link)];
  }
  /// Points of all legs; NaN where the description has no such point.
  std::array<LegPoints, kNumLegs> legs() const noexcept;
  /// Height of the outline's lowest point; NaN if a joint position is NaN, infinity without
  /// outline.
  double lowest_m() const noexcept;

 private:
  struct Link {
    int parent = -1;
    RobotFrame frame;
  };
  struct Point {
    int link = -1;
    Vector3 centre_m{};
    double radius_m = 0.0;
  };
  Vector3 placed(const Point& point) const noexcept;

  std::vector<Link> links_;
  std::vector<Point> outline_;
  std::array<int, kNumLegs> feet_;  // indices in outline_; -1: none
  JointArray<int> joint_links_;
  Pose base_;
  std::vector<Pose> poses_;
};

}  // namespace sandrunner
