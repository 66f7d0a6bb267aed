// SPDX-License-Identifier: BSD-3-Clause
// Bodies, joints and shapes out of a URDF, by name.
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

/// Where a link is in the frame of another one, with all joints at zero.
struct Placed {
  Mat3<double> turn{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3<double> place_m;
};

/// A ball, a tyre that rolls forward, or the sole that a box is. Vectors in base axes.
struct UrdfFoot {
  Vec3<double> centre_m{};      ///< from the link's origin
  Vec3<double> in_link_m{};     ///< the same in the link's own axes
  double radius_m = 0.0;        ///< of a sole half its thickness
  double width_m = 0.0;         ///< 0: a ball
  double length_m = 0.0;        ///< of a sole; 0: a ball or tyre
  Vec3<double> along{1, 0, 0};  ///< its length
  Vec3<double> across{0, 1, 0};
};

/// A box with edges along the base's axes, m.
struct UrdfBox {
  Vec3<double> centre_m, half_m;
};

/// Reads a URDF under the names that a robot's map gives. However its frames are turned, all
/// vectors come in *base axes*: those of the base's link, with all joints at zero. Every error is
/// an InputError of one line that names the URDF and the element.
class UrdfReader {
 public:
  /// `name` stands for the text in errors; `base`: the link with the base's axes.
  UrdfReader(const std::string& text, std::string name, std::string base = {});

  [[noreturn]] void fail(const std::string& what) const;

  const urdf::Link& link(const std::string& link_name) const;
  /// The joint from `parent`, or from a link that is fixed to it, to `child`. `place_m`: from the
  /// origin of `parent` to the joint's; `axis`: a unit vector.
  const urdf::Joint& joint(const std::string& joint_name, const std::string& parent,
                           const std::string& child, Vec3<double>& place_m,
                           Vec3<double>& axis) const;
  /// Fails unless a joint can move between these stops.
  void check_stops(const std::string& joint_name, double lower_rad, double upper_rad) const;
  /// Mass, centre of mass (from the link's origin) and inertia of a link and all that is fixed to
  /// it; of the base also of what it is fixed to.
  Body<double> body(const std::string& link_name) const;

  /// The largest collision box of the base, or else of a link that is fixed to it; a turned one
  /// counts with what it takes up along the base's axes.
  std::optional<UrdfBox> box() const;
  /// The collision shape of a foot that reaches furthest towards `down`: a sphere, or a cylinder
  /// along y; where there is none of these, a box. Fails without one.
  UrdfFoot foot(const std::string& link_name, const Vec3<double>& down) const;

  /// All of it.
  const urdf::ModelInterface& model() const { return *urdf_; }
  /// Names of the joints that can move, but for a floating one that leaves the base free.
  std::vector<std::string> moving_joints() const;
  /// Fails for a mass that is part of no body(): left out, the robot would be too light.
  void reject_other_masses() const;

 private:
  Placed in_base(const urdf::Link& link) const;
  Body<double> body_alone(const urdf::Link& link) const;
  Body<double> body_with_fixed(const urdf::Link& link) const;
  Body<double> body_with_carriers(const urdf::Link& link) const;
  void add_boxes(const urdf::Link& link, const Placed& placed,
                 std::optional<UrdfBox>& largest) const;

  std::string name_, base_;
  urdf::ModelInterfaceSharedPtr urdf_;
  mutable std::set<std::string> bodies_;
};

Vec3<double> to_vec(const urdf::Vector3& v);

}  // namespace sandrunner::sim
