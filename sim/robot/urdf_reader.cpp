// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>

#include "rt/base/errors.h"
#include "sim/robot/inertia.h"
#include "sim/robot/urdf_text.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;

// urdfdom reports through console_bridge and returns null. The first thing it says names the
// element; the rest would be noise beside our one line.
class FirstMessage : public console_bridge::OutputHandler {
 public:
  FirstMessage() { console_bridge::useOutputHandler(this); }
  ~FirstMessage() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& message, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || !text.empty()) return;
    for (const char c : message) text += c == '\n' ? ' ' : c;
  }
  mutable std::string text;
};

// To compare shapes of one kind; for spheres any measure of size will do.
double size_of(const urdf::Box& b) { return b.dim.x * b.dim.y * b.dim.z; }
double size_of(const urdf::Cylinder& c) { return c.radius * c.radius * c.length; }
double size_of(const urdf::Sphere& s) { return s.radius; }

Sym3<double> rotated(const Sym3<double>& m, const urdf::Rotation& q) {
  const Mat3<double> r = rotation_matrix(Quaternion<double>{q.w, q.x, q.y, q.z});
  const Vec a = m * r.r0, b = m * r.r1, c = m * r.r2;
  return {dot(r.r0, a), dot(r.r0, b), dot(r.r0, c), dot(r.r1, b), dot(r.r1, c), dot(r.r2, c)};
}

bool is_rotated(const urdf::Joint& joint) {
  const auto& q = joint.parent_to_joint_origin_transform.rotation;
  return std::fabs(q.x) + std::fabs(q.y) + std::fabs(q.z) > 1e-6;
}

// What a fixed joint joins becomes one body, in the frame of `parent`.
Body<double> merged(const Body<double>& parent, const Body<double>& child,
                    const urdf::Pose& child_in_parent) {
  const urdf::Rotation& q = child_in_parent.rotation;
  const Vec child_com = rotation_matrix(Quaternion<double>{q.w, q.x, q.y, q.z}) * child.com +
                        to_vec(child_in_parent.position);
  Body<double> b;
  b.mass = parent.mass + child.mass;
  b.com = (1.0 / b.mass) * (parent.mass * parent.com + child.mass * child_com);
  b.inertia = shifted_inertia(parent.inertia, parent.mass, parent.com - b.com) +
              shifted_inertia(rotated(child.inertia, q), child.mass, child_com - b.com);
  return b;
}

}  // namespace

Vec to_vec(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

UrdfReader::UrdfReader(const std::string& text, std::string name) : name_(std::move(name)) {
  if (text.find("<robot") == std::string::npos) fail("not a URDF: has no robot element");
  const FirstMessage message;
  urdf_ = urdf::parseURDF(tolerable_urdf(text, name_));
  if (!urdf_) {
    fail(message.text.empty() ? "not a valid URDF" : "not a valid URDF: " + message.text);
  }
}

void UrdfReader::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: {}", name_, what));
}

const urdf::Link& UrdfReader::link(const std::string& link_name) const {
  const auto found = urdf_->links_.find(link_name);
  if (found == urdf_->links_.end()) fail(fmt::format("has no link '{}'", link_name));
  return *found->second;
}

void UrdfReader::require_unrotated(const urdf::Joint& joint) const {
  if (!is_rotated(joint)) return;
  fail(fmt::format("joint '{}' has a rotated origin, expected rpy 0 0 0", joint.name));
}

const urdf::Joint& UrdfReader::joint(const std::string& joint_name, const std::string& parent,
                                     const std::string& child, Vec& place_m) const {
  const auto found = urdf_->joints_.find(joint_name);
  if (found == urdf_->joints_.end()) fail(fmt::format("has no joint '{}'", joint_name));
  const urdf::Joint& j = *found->second;
  require_unrotated(j);
  place_m = to_vec(j.parent_to_joint_origin_transform.position);
  const urdf::Link* from = &link(j.parent_link_name);
  while (from->name != parent && from->parent_joint &&
         from->parent_joint->type == urdf::Joint::FIXED) {
    require_unrotated(*from->parent_joint);
    place_m = place_m + to_vec(from->parent_joint->parent_to_joint_origin_transform.position);
    from = &link(from->parent_joint->parent_link_name);
  }
  if (from->name != parent || j.child_link_name != child) {
    fail(fmt::format("joint '{}' connects '{}' to '{}', expected '{}' to '{}'", joint_name,
                     j.parent_link_name, j.child_link_name, parent, child));
  }
  return j;
}

// Of the link itself; without a mass it is a frame.
Body<double> UrdfReader::body_alone(const urdf::Link& link) const {
  if (!link.inertial || link.inertial->mass == 0.0) return {};
  const urdf::Inertial& i = *link.inertial;
  Body<double> b{i.mass, to_vec(i.origin.position), {i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz}};
  b.inertia = rotated(b.inertia, i.origin.rotation);
  const double trace = b.inertia.xx + b.inertia.yy + b.inertia.zz;
  const double all =
      b.mass + b.com.x + b.com.y + b.com.z + trace + b.inertia.xy + b.inertia.xz + b.inertia.yz;
  if (!std::isfinite(all) || b.mass < 0.0) {
    fail(fmt::format("link '{}' has mass {}, expected a positive finite one", link.name, b.mass));
  }
  if (!is_inertia_of_a_body(b.inertia)) {
    fail(
        fmt::format("link '{}' has an inertia that no body can have: each of the three principal "
                    "moments must be above 0 and at most the sum of the other two",
                    link.name));
  }
  return b;
}

Body<double> UrdfReader::body_with_fixed(const urdf::Link& link) const {
  bodies_.insert(link.name);
  Body<double> b = body_alone(link);
  for (const auto& joint : link.child_joints) {
    if (joint->type != urdf::Joint::FIXED) continue;
    const Body<double> child = body_with_fixed(this->link(joint->child_link_name));
    if (child.mass > 0.0) b = merged(b, child, joint->parent_to_joint_origin_transform);
  }
  return b;
}

Body<double> UrdfReader::body(const std::string& link_name) const {
  const Body<double> b = body_with_fixed(link(link_name));
  if (!(b.mass > 0.0)) {
    fail(fmt::format("link '{}' has no mass, nor has a link that is fixed to it", link_name));
  }
  return b;
}

template <typename Shape>
const Shape* UrdfReader::largest(const std::string& link_name, int type, Vec* centre) const {
  const Shape* best = nullptr;
  for (const auto& collision : link(link_name).collision_array) {
    if (!collision->geometry || collision->geometry->type != type) continue;
    const auto* s = static_cast<const Shape*>(collision->geometry.get());
    if (best && size_of(*s) <= size_of(*best)) continue;
    best = s;
    if (centre) *centre = to_vec(collision->origin.position);
  }
  return best;
}

const urdf::Box* UrdfReader::box(const std::string& link_name, Vec& centre) const {
  const urdf::Box* own = largest<urdf::Box>(link_name, urdf::Geometry::BOX, &centre);
  if (own) return own;
  for (const auto& joint : link(link_name).child_joints) {
    if (joint->type != urdf::Joint::FIXED || is_rotated(*joint)) continue;
    if (const urdf::Box* const fixed = box(joint->child_link_name, centre)) {
      centre = centre + to_vec(joint->parent_to_joint_origin_transform.position);
      return fixed;
    }
  }
  return nullptr;
}
const urdf::Cylinder* UrdfReader::cylinder(const std::string& link_name) const {
  return largest<urdf::Cylinder>(link_name, urdf::Geometry::CYLINDER, nullptr);
}
const urdf::Sphere* UrdfReader::sphere(const std::string& link_name) const {
  return largest<urdf::Sphere>(link_name, urdf::Geometry::SPHERE, nullptr);
}

void UrdfReader::reject_other_masses() const {
  for (const auto& [link_name, l] : urdf_->links_) {
    if (!l->inertial || !(l->inertial->mass > 0.0) || bodies_.contains(link_name)) continue;
    fail(
        fmt::format("link '{}' has a mass but is neither base nor leg, nor fixed below one; let "
                    "links.base of the map name the root",
                    link_name));
  }
}

std::size_t UrdfReader::moving_joints() const {
  std::size_t n = 0;
  for (const auto& [joint_name, j] : urdf_->joints_) n += j->type != urdf::Joint::FIXED;
  return n;
}

}  // namespace sandrunner::sim
