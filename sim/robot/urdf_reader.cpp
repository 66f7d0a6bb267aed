// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

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

Sym3<double> turned(const Mat3<double>& r, const Sym3<double>& m) {
  const Vec a = m * r.r0, b = m * r.r1, c = m * r.r2;
  return {dot(r.r0, a), dot(r.r0, b), dot(r.r0, c), dot(r.r1, b), dot(r.r1, c), dot(r.r2, c)};
}

Mat3<double> transposed(const Mat3<double>& m) {
  return {{m.r0.x, m.r1.x, m.r2.x}, {m.r0.y, m.r1.y, m.r2.y}, {m.r0.z, m.r1.z, m.r2.z}};
}

Placed placed(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {rotation_matrix(Quaternion<double>{q.w, q.x, q.y, q.z}), to_vec(pose.position)};
}

Placed placed(const urdf::Joint& joint) { return placed(joint.parent_to_joint_origin_transform); }

/// `inner` is given in a frame that is itself at `outer`.
Placed operator*(const Placed& outer, const Placed& inner) {
  return {outer.turn * inner.turn, outer.turn * inner.place_m + outer.place_m};
}

Body<double> moved(const Placed& placed, const Body<double>& body) {
  return {body.mass, placed.turn * body.com + placed.place_m, turned(placed.turn, body.inertia)};
}

// Two bodies in one frame as one.
Body<double> merged(const Body<double>& a, const Body<double>& b) {
  Body<double> both;
  both.mass = a.mass + b.mass;
  both.com = (1.0 / both.mass) * (a.mass * a.com + b.mass * b.com);
  both.inertia = shifted_inertia(a.inertia, a.mass, a.com - both.com) +
                 shifted_inertia(b.inertia, b.mass, b.com - both.com);
  return both;
}

/// The link that a fixed joint carries it with; null: none does.
const urdf::Link* carrier(const urdf::ModelInterface& model, const urdf::Link& link) {
  const bool is_fixed = link.parent_joint && link.parent_joint->type == urdf::Joint::FIXED;
  return is_fixed ? model.getLink(link.parent_joint->parent_link_name).get() : nullptr;
}

double volume(const Vec& half) { return half.x * half.y * half.z; }

// The sole has the two edges that are most across `down`; its length is the one nearer to x.
void make_sole(const urdf::Vector3& edges, const Mat3<double>& turn, const Vec& down,
               UrdfFoot& foot) {
  struct Edge {
    Vec axis;
    double length_m;
  };
  std::array<Edge, 3> e{{{turn * Vec{1, 0, 0}, edges.x},
                         {turn * Vec{0, 1, 0}, edges.y},
                         {turn * Vec{0, 0, 1}, edges.z}}};
  std::ranges::stable_sort(e, std::greater(),
                           [&](const Edge& edge) { return std::fabs(dot(edge.axis, down)); });
  if (std::fabs(e[1].axis.x) < std::fabs(e[2].axis.x)) std::swap(e[1], e[2]);
  foot.radius_m = e[0].length_m / 2;
  foot.length_m = e[1].length_m;
  foot.width_m = e[2].length_m;
  foot.along = std::copysign(1.0, e[1].axis.x) * e[1].axis;
  foot.across = std::copysign(1.0, e[2].axis.y) * e[2].axis;
}

}  // namespace

Vec to_vec(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

UrdfReader::UrdfReader(const std::string& text, std::string name, std::string base)
    : name_(std::move(name)), base_(std::move(base)) {
  if (text.find("<robot") == std::string::npos) fail("not a URDF: has no robot element");
  const FirstMessage message;
  urdf_ = urdf::parseURDF(tolerable_urdf(text, name_));
  if (!urdf_) {
    fail(message.text.empty() ? "not a valid URDF" : "not a valid URDF: " + message.text);
  }
  // So links are a tree: the parser lets circles pass.
  std::set<std::string> children;
  for (const auto& [joint_name, joint] : urdf_->joints_) {
    if (children.insert(joint->child_link_name).second) continue;
    for (const auto& [link_name, link] : urdf_->links_) link->child_links.clear();  // frees circles
    fail(fmt::format("two joints carry the link '{}', expected one", joint->child_link_name));
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

Placed UrdfReader::in_base(const urdf::Link& link) const {
  if (link.name == base_ || !link.parent_joint) return {};
  return in_base(this->link(link.parent_joint->parent_link_name)) * placed(*link.parent_joint);
}

const urdf::Joint& UrdfReader::joint(const std::string& joint_name, const std::string& parent,
                                     const std::string& child, Vec& place_m, Vec& axis) const {
  const auto found = urdf_->joints_.find(joint_name);
  if (found == urdf_->joints_.end()) fail(fmt::format("has no joint '{}'", joint_name));
  const urdf::Joint& j = *found->second;
  Placed in_parent = placed(j);
  const urdf::Link* from = &link(j.parent_link_name);
  while (from->name != parent && carrier(*urdf_, *from)) {
    in_parent = placed(*from->parent_joint) * in_parent;
    from = carrier(*urdf_, *from);
  }
  if (from->name != parent || j.child_link_name != child) {
    fail(fmt::format("joint '{}' connects '{}' to '{}', expected '{}' to '{}'", joint_name,
                     j.parent_link_name, j.child_link_name, parent, child));
  }
  place_m = in_base(*from).turn * in_parent.place_m;
  axis = in_base(link(child)).turn * to_vec(j.axis);
  return j;
}

void UrdfReader::check_stops(const std::string& joint_name, double lower_rad,
                             double upper_rad) const {
  if (lower_rad < upper_rad) return;
  fail(fmt::format("joint '{}': found stops {} and {}, expected lower < upper", joint_name,
                   lower_rad, upper_rad));
}

// Of the link itself; without a mass it is a frame.
Body<double> UrdfReader::body_alone(const urdf::Link& link) const {
  if (!link.inertial || link.inertial->mass == 0.0) return {};
  const urdf::Inertial& i = *link.inertial;
  Body<double> b{i.mass, to_vec(i.origin.position), {i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz}};
  b.inertia = turned(placed(i.origin).turn, b.inertia);
  const double trace = b.inertia.xx + b.inertia.yy + b.inertia.zz;
  const double all =
      b.mass + b.com.x + b.com.y + b.com.z + trace + b.inertia.xy + b.inertia.xz + b.inertia.yz;
  if (!std::isfinite(all) || b.mass < 0.0) {
    fail(fmt::format("link '{}' has mass {}, expected a positive finite one", link.name, b.mass));
  }
  return b;
}

Body<double> UrdfReader::body_with_fixed(const urdf::Link& link) const {
  bodies_.insert(link.name);
  Body<double> b = body_alone(link);
  for (const auto& joint : link.child_joints) {
    if (joint->type != urdf::Joint::FIXED) continue;
    const Body<double> child = body_with_fixed(this->link(joint->child_link_name));
    if (child.mass > 0.0) b = merged(b, moved(placed(*joint), child));
  }
  return b;
}

// With what a link is fixed to, if anything there weighs something.
Body<double> UrdfReader::body_with_carriers(const urdf::Link& link) const {
  const Body<double> below = body_with_fixed(link);
  const urdf::Link* top = &link;
  Placed in_top;
  while (const urdf::Link* const above = carrier(*urdf_, *top)) {
    in_top = placed(*top->parent_joint) * in_top;
    top = above;
  }
  const Body<double> all = body_with_fixed(*top);
  if (all.mass == below.mass) return below;
  const Mat3<double> back = transposed(in_top.turn);
  return moved({back, -1.0 * (back * in_top.place_m)}, all);
}

Body<double> UrdfReader::body(const std::string& link_name) const {
  const urdf::Link& link = this->link(link_name);
  const Body<double> b = link_name == base_ ? body_with_carriers(link) : body_with_fixed(link);
  if (!(b.mass > 0.0)) {
    fail(fmt::format("link '{}' has no mass, nor has a link that is fixed to it", link_name));
  }
  // A part alone may have none: a sensor of a gram, a root that is a name.
  if (!is_inertia_of_a_body(b.inertia)) {
    fail(
        fmt::format("link '{}', with all that is fixed to it, has an inertia that no body can "
                    "have: each of the three principal moments must be above 0 and at most the sum "
                    "of the other two",
                    link_name));
  }
  return moved({in_base(link).turn, {}}, b);
}

void UrdfReader::add_boxes(const urdf::Link& link, const Placed& place,
                           std::optional<UrdfBox>& largest) const {
  bool has_one = false;
  for (const auto& collision : link.collision_array) {
    if (!collision->geometry || collision->geometry->type != urdf::Geometry::BOX) continue;
    const auto& box = static_cast<const urdf::Box&>(*collision->geometry);
    const Placed in_base = place * placed(collision->origin);
    const Vec half{box.dim.x / 2, box.dim.y / 2, box.dim.z / 2};
    const auto reach = [&half](const Vec& row) {
      return std::fabs(row.x) * half.x + std::fabs(row.y) * half.y + std::fabs(row.z) * half.z;
    };
    const UrdfBox shape{in_base.place_m,
                        {reach(in_base.turn.r0), reach(in_base.turn.r1), reach(in_base.turn.r2)}};
    has_one = true;
    if (!largest || volume(shape.half_m) > volume(largest->half_m)) largest = shape;
  }
  if (has_one) return;
  for (const auto& joint : link.child_joints) {
    if (joint->type != urdf::Joint::FIXED) continue;
    add_boxes(this->link(joint->child_link_name), place * placed(*joint), largest);
  }
}

std::optional<UrdfBox> UrdfReader::box() const {
  std::optional<UrdfBox> largest;
  add_boxes(link(base_), {}, largest);
  return largest;
}

UrdfFoot UrdfReader::foot(const std::string& link_name, const Vec& down) const {
  const Placed link_axes{in_base(link(link_name)).turn, {}};
  std::optional<UrdfFoot> lowest, sole;
  std::string others;
  const auto reach = [&](const UrdfFoot& s) { return dot(s.centre_m, down) + s.radius_m; };
  for (const auto& collision : link(link_name).collision_array) {
    if (!collision->geometry) continue;
    const Placed in_base = link_axes * placed(collision->origin);
    UrdfFoot shape{.centre_m = in_base.place_m, .in_link_m = to_vec(collision->origin.position)};
    switch (collision->geometry->type) {
      case urdf::Geometry::SPHERE:
        shape.radius_m = static_cast<const urdf::Sphere&>(*collision->geometry).radius;
        break;
      case urdf::Geometry::CYLINDER: {
        const auto& tyre = static_cast<const urdf::Cylinder&>(*collision->geometry);
        const Vec axis = in_base.turn * Vec{0, 0, 1};
        if (std::fabs(axis.y) < 0.99) {
          others += fmt::format(", a cylinder along {:.2g} {:.2g} {:.2g}", axis.x, axis.y, axis.z);
          continue;
        }
        shape.radius_m = tyre.radius;
        shape.width_m = tyre.length;
        break;
      }
      case urdf::Geometry::BOX:
        make_sole(static_cast<const urdf::Box&>(*collision->geometry).dim, in_base.turn, down,
                  shape);
        if (shape.radius_m > 0.0 && (!sole || reach(shape) > reach(*sole))) sole = shape;
        continue;
      default:
        others += ", a mesh";
        continue;
    }
    if (shape.radius_m > 0.0 && (!lowest || reach(shape) > reach(*lowest))) lowest = shape;
  }
  if (lowest) return *lowest;
  if (sole) return *sole;
  fail(
      fmt::format("link '{}': found {}, expected a collision sphere, cylinder along y or box, or "
                  "collision.foot_radius_m in the robot file",
                  link_name, others.empty() ? "no collision shape" : others.substr(2)));
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

std::vector<std::string> UrdfReader::moving_joints() const {
  const urdf::Link* top = &link(base_);
  while (const urdf::Link* const above = carrier(*urdf_, *top)) top = above;
  std::vector<std::string> names;
  for (const auto& [joint_name, j] : urdf_->joints_) {
    const bool leaves_the_base_free =
        j->type == urdf::Joint::FLOATING && j->child_link_name == top->name;
    if (j->type != urdf::Joint::FIXED && !leaves_the_base_free) names.push_back(joint_name);
  }
  return names;
}

}  // namespace sandrunner::sim
