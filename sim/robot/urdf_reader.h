// SPDX-License-Identifier: BSD-3-Clause
// Bodies, joints and shapes out of a URDF, by name.
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <cstddef>
#include <set>
#include <string>

#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

/// Reads a URDF under the names that a robot's map gives. Every error is an InputError of one line
/// that names the URDF and the element.
class UrdfReader {
 public:
  /// `name` stands for the text in errors.
  UrdfReader(const std::string& text, std::string name);

  [[noreturn]] void fail(const std::string& what) const;

  const urdf::Link& link(const std::string& link_name) const;
  /// The joint from `parent`, or from a link that is fixed to it, to `child`; no origin on the way
  /// may be rotated. `place_m`: its place in the frame of `parent`.
  const urdf::Joint& joint(const std::string& joint_name, const std::string& parent,
                           const std::string& child, Vec3<double>& place_m) const;
  /// Mass, centre of mass and inertia of a link and all links fixed to it, in the link's frame.
  Body<double> body(const std::string& link_name) const;

  /// The largest collision box of a link with its centre in the link's frame (m); if it has none,
  /// that of a link fixed to it without a rotation; null: none.
  const urdf::Box* box(const std::string& link_name, Vec3<double>& centre) const;
  /// The largest collision shape of a kind; null: none.
  const urdf::Cylinder* cylinder(const std::string& link_name) const;
  const urdf::Sphere* sphere(const std::string& link_name) const;

  /// All of it.
  const urdf::ModelInterface& model() const { return *urdf_; }
  std::size_t moving_joints() const;
  /// Fails for a mass that is part of no body(): left out, the robot would be too light.
  void reject_other_masses() const;

 private:
  template <typename Shape>
  const Shape* largest(const std::string& link_name, int type, Vec3<double>* centre) const;
  void require_unrotated(const urdf::Joint& joint) const;
  Body<double> body_alone(const urdf::Link& link) const;
  Body<double> body_with_fixed(const urdf::Link& link) const;

  std::string name_;
  urdf::ModelInterfaceSharedPtr urdf_;
  mutable std::set<std::string> bodies_;
};

Vec3<double> to_vec(const urdf::Vector3& v);

}  // namespace sandrunner::sim
