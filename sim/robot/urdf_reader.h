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
  /// The joint from `parent` to `child`; its origin must not be rotated.
  const urdf::Joint& joint(const std::string& joint_name, const std::string& parent,
                           const std::string& child) const;
  /// Mass, centre of mass and inertia of a link, in the link's frame.
  Body<double> body(const std::string& link_name) const;

  /// The largest collision shape of a kind, with its centre in the link's frame (m); null: none.
  const urdf::Box* box(const std::string& link_name, Vec3<double>& centre) const;
  const urdf::Cylinder* cylinder(const std::string& link_name) const;
  const urdf::Sphere* sphere(const std::string& link_name) const;

  /// All of it.
  const urdf::ModelInterface& model() const { return *urdf_; }
  std::size_t moving_joints() const;
  /// Fails for a mass that no body() has asked for: left out, the robot would be too light.
  void reject_other_masses() const;

 private:
  template <typename Shape>
  const Shape* largest(const std::string& link_name, int type, Vec3<double>* centre) const;

  std::string name_;
  urdf::ModelInterfaceSharedPtr urdf_;
  mutable std::set<std::string> bodies_;
};

Vec3<double> to_vec(const urdf::Vector3& v);

}  // namespace sandrunner::sim
