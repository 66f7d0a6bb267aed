// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <regex>

#include "rt/base/errors.h"

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

// Exporters write blanks inside numbers' quotes and <dynamics> without the attributes that urdfdom
// insists on; neither means anything to us.
std::string tolerable(const std::string& text) {
  static const std::regex dynamics(R"(<dynamics[^>]*/>)"), before(R"(="\s+)"),
      after(R"(\s+"(\s|/|>))");
  std::string t = std::regex_replace(text, dynamics, "");
  t = std::regex_replace(t, before, "=\"");
  return std::regex_replace(t, after, "\"$1");
}

// To compare shapes of one kind; for spheres any measure of size will do.
double size_of(const urdf::Box& b) { return b.dim.x * b.dim.y * b.dim.z; }
double size_of(const urdf::Cylinder& c) { return c.radius * c.radius * c.length; }
double size_of(const urdf::Sphere& s) { return s.radius; }

Sym3<double> rotated(const Sym3<double>& m, const urdf::Rotation& q) {
  const Mat3<double> r = rotation_matrix(Quaternion<double>{q.w, q.x, q.y, q.z});
  const Vec a = m * r.r0, b = m * r.r1, c = m * r.r2;
  return {dot(r.r0, a), dot(r.r0, b), dot(r.r0, c), dot(r.r1, b), dot(r.r1, c), dot(r.r2, c)};
}

}  // namespace

Vec to_vec(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

UrdfReader::UrdfReader(const std::string& text, std::string name) : name_(std::move(name)) {
  if (text.find("<robot") == std::string::npos) fail("not a URDF: has no robot element");
  const FirstMessage message;
  urdf_ = urdf::parseURDF(tolerable(text));
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

const urdf::Joint& UrdfReader::joint(const std::string& joint_name, const std::string& parent,
                                     const std::string& child) const {
  const auto found = urdf_->joints_.find(joint_name);
  if (found == urdf_->joints_.end()) fail(fmt::format("has no joint '{}'", joint_name));
  const urdf::Joint& j = *found->second;
  if (j.parent_link_name != parent || j.child_link_name != child) {
    fail(fmt::format("joint '{}' connects '{}' to '{}', expected '{}' to '{}'", joint_name,
                     j.parent_link_name, j.child_link_name, parent, child));
  }
  const auto& q = j.parent_to_joint_origin_transform.rotation;
  if (std::fabs(q.x) + std::fabs(q.y) + std::fabs(q.z) > 1e-6) {
    fail(fmt::format("joint '{}' has a rotated origin, expected rpy 0 0 0", joint_name));
  }
  return j;
}

Body<double> UrdfReader::body(const std::string& link_name) const {
  const urdf::Link& l = link(link_name);
  bodies_.insert(link_name);
  if (!l.inertial) fail(fmt::format("link '{}' has no inertial", link_name));
  const urdf::Inertial& i = *l.inertial;
  Body<double> b{i.mass, to_vec(i.origin.position), {i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz}};
  b.inertia = rotated(b.inertia, i.origin.rotation);
  const double trace = b.inertia.xx + b.inertia.yy + b.inertia.zz;
  const double all =
      b.mass + b.com.x + b.com.y + b.com.z + trace + b.inertia.xy + b.inertia.xz + b.inertia.yz;
  if (!std::isfinite(all) || b.mass <= 0.0) {
    fail(fmt::format("link '{}' has mass {}, expected a positive finite one", link_name, b.mass));
  }
  const double d2 = b.inertia.xx * b.inertia.yy - b.inertia.xy * b.inertia.xy;
  const double d3 = b.inertia.xx * (b.inertia.yy * b.inertia.zz - b.inertia.yz * b.inertia.yz) -
                    b.inertia.xy * (b.inertia.xy * b.inertia.zz - b.inertia.yz * b.inertia.xz) +
                    b.inertia.xz * (b.inertia.xy * b.inertia.yz - b.inertia.yy * b.inertia.xz);
  if (b.inertia.xx <= 0.0 || d2 <= 0.0 || d3 <= 0.0) {
    fail(fmt::format("link '{}' has an inertia that is not positive definite", link_name));
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
  return largest<urdf::Box>(link_name, urdf::Geometry::BOX, &centre);
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
        fmt::format("link '{}' has a mass but is no link of base, legs or feet; add it to the "
                    "one that it is fixed to",
                    link_name));
  }
}

std::size_t UrdfReader::moving_joints() const {
  std::size_t n = 0;
  for (const auto& [joint_name, j] : urdf_->joints_) n += j->type != urdf::Joint::FIXED;
  return n;
}

}  // namespace sandrunner::sim
