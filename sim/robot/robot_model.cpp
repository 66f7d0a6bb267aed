// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/robot_model.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "sim/robot/embedded.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;

Vec to_vec(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

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

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read, expected a robot description", path));
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// Reads links and joints of one URDF under the names that the map gives; every refusal is one line
// with both names.
class UrdfReader {
 public:
  UrdfReader(const std::string& text, std::string name) : name_(std::move(name)) {
    if (text.find("<robot") == std::string::npos) fail("not a URDF: has no robot element");
    const FirstMessage message;
    urdf_ = urdf::parseURDF(tolerable(text));
    if (!urdf_) {
      fail(message.text.empty() ? "not a valid URDF" : "not a valid URDF: " + message.text);
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_, what));
  }

  const urdf::Link& link(const std::string& link_name) const {
    const auto found = urdf_->links_.find(link_name);
    if (found == urdf_->links_.end()) fail(fmt::format("has no link '{}'", link_name));
    return *found->second;
  }

  const urdf::Joint& joint(const std::string& joint_name, const std::string& parent,
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

  Body<double> body(const std::string& link_name) const {
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
  const Shape* shape(const std::string& link_name, int type, Vec* centre) const {
    const Shape* best = nullptr;
    for (const auto& collision : link(link_name).collision_array) {
      if (!collision->geometry || collision->geometry->type != type) continue;
      const auto* s = static_cast<const Shape*>(collision->geometry.get());
      if (best && volume(*s) <= volume(*best)) continue;
      best = s;
      if (centre) *centre = to_vec(collision->origin.position);
    }
    return best;
  }

  /// Fails for a mass that no body() has asked for: left out, the robot would be too light.
  void refuse_other_masses() const {
    for (const auto& [link_name, l] : urdf_->links_) {
      if (!l->inertial || !(l->inertial->mass > 0.0) || bodies_.contains(link_name)) continue;
      fail(
          fmt::format("link '{}' has a mass but is no link of base, legs or feet; add it to the "
                      "one that it is fixed to",
                      link_name));
    }
  }

  std::size_t moving_joints() const {
    std::size_t n = 0;
    for (const auto& [joint_name, j] : urdf_->joints_) n += j->type != urdf::Joint::FIXED;
    return n;
  }

 private:
  static double volume(const urdf::Box& b) { return b.dim.x * b.dim.y * b.dim.z; }
  static double volume(const urdf::Cylinder& c) { return c.radius * c.radius * c.length; }
  static double volume(const urdf::Sphere& s) { return s.radius; }

  static Sym3<double> rotated(const Sym3<double>& m, const urdf::Rotation& q) {
    const Mat3<double> r = rotation_matrix(Quaternion<double>{q.w, q.x, q.y, q.z});
    const Vec a = m * r.r0, b = m * r.r1, c = m * r.r2;
    return {dot(r.r0, a), dot(r.r0, b), dot(r.r0, c), dot(r.r1, b), dot(r.r1, c), dot(r.r2, c)};
  }

  std::string name_;
  urdf::ModelInterfaceSharedPtr urdf_;
  mutable std::set<std::string> bodies_;
};

// What a fixed joint joins becomes one body: `child` sits at `offset` in the frame of `parent`.
Body<double> merged(const Body<double>& parent, const Body<double>& child, const Vec& offset) {
  const Vec child_com = child.com + offset;
  Body<double> b;
  b.mass = parent.mass + child.mass;
  b.com = (1.0 / b.mass) * (parent.mass * parent.com + child.mass * child_com);
  b.inertia = shifted_inertia(parent.inertia, parent.mass, parent.com - b.com) +
              shifted_inertia(child.inertia, child.mass, child_com - b.com);
  return b;
}

std::string with_leg(std::string pattern, const std::string& leg) {
  const auto at = pattern.find("{leg}");
  if (at != std::string::npos) pattern.replace(at, 5, leg);
  return pattern;
}

// Height of the base at which the lowest foot of a pose touches level ground.
double standing_height(const RobotModel<double>& m, const JointArray<double>& q) {
  double lowest = 0.0;
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = m.legs[l];
    double s1, c1, s2, c2, s23, c23;
    sincos(q[3 * l], s1, c1);
    sincos(q[3 * l + 1], s2, c2);
    sincos(q[3 * l + 1] + q[3 * l + 2], s23, c23);
    const Vec knee = leg.hfe + rotate_y(s2, c2, leg.kfe);
    const Vec foot = knee + rotate_y(s23, c23, leg.foot);
    lowest = std::fmin(lowest, (leg.haa + rotate_x(s1, c1, foot)).z - m.foot_radius_m);
    lowest = std::fmin(lowest, (leg.haa + rotate_x(s1, c1, knee)).z - m.knee_radius_m);
  }
  return -std::fmin(lowest, m.base_box_centre_m.z - m.base_box_half_m.z);
}

}  // namespace

Robot parse_robot(const std::string& map_text, const std::string& map_name,
                  const std::string& urdf_text, const std::string& urdf_name) {
  ConfigTree map;
  map.add_text(map_text, map_name);
  const UrdfReader urdf(urdf_text, urdf_name);
  Robot robot;
  RobotModel<double>& m = robot.model;
  robot.description.name = map.text("name", "robot");
  map.text("urdf", "");
  const std::string base = map.text("links.base", "base");
  const std::array<std::string, kNumLegs> leg_names{
      map.text("legs.left_front", "LF"), map.text("legs.right_front", "RF"),
      map.text("legs.left_hind", "LH"), map.text("legs.right_hind", "RH")};
  const std::array<std::string, 3> joint_names{map.text("joints.haa", "{leg}_HAA"),
                                               map.text("joints.hfe", "{leg}_HFE"),
                                               map.text("joints.kfe", "{leg}_KFE")};
  const std::array<std::string, 3> link_names{map.text("links.hip", "{leg}_HIP"),
                                              map.text("links.thigh", "{leg}_THIGH"),
                                              map.text("links.shank", "{leg}_SHANK")};
  const std::string foot_pattern = map.text("links.foot", "{leg}_FOOT");
  const double rotor = map.number("joints.rotor_inertia_kgm2", 0.0, 0.0, 1.0);
  m.knee_radius_m = map.number("collision.knee_radius_m", 0.02, 0.0, 0.5);
  m.shank_radius_m = map.number("collision.shank_radius_m", 0.01, 0.0, 0.5);
  const auto nominal = map.numbers("pose.nominal_rad", {0.0, 0.6, -1.2}, 3, -7.0, 7.0);
  const auto lying = map.numbers("pose.lying_rad", {0.0, 2.5, -2.4}, 3, -7.0, 7.0);
  const double nominal_height = map.number("pose.nominal_height_m", 0.0, 0.0, 5.0);
  map.reject_unknown();

  m.base = urdf.body(base);
  Vec centre;
  const auto* box = urdf.shape<urdf::Box>(base, urdf::Geometry::BOX, &centre);
  if (!box) urdf.fail(fmt::format("link '{}' has no collision box", base));
  m.base_box_centre_m = centre;
  m.base_box_half_m = {box->dim.x / 2, box->dim.y / 2, box->dim.z / 2};
  if (urdf.moving_joints() != kNumJoints) {
    urdf.fail(fmt::format("has {} moving joints, expected {}: four legs of HAA, HFE, KFE",
                          urdf.moving_joints(), kNumJoints));
  }
  for (int l = 0; l < kNumLegs; ++l) {
    LegModel<double>& leg = m.legs[l];
    std::string parent = base;
    Vec origins[3];
    for (int j = 0; j < 3; ++j) {
      const std::string joint_name = with_leg(joint_names[j], leg_names[l]);
      robot.description.joint_names[3 * l + j] = joint_name;
      const std::string child = with_leg(link_names[j], leg_names[l]);
      const urdf::Joint& joint = urdf.joint(joint_name, parent, child);
      const Vec axis = to_vec(joint.axis);
      const Vec wanted = j == 0 ? Vec{1, 0, 0} : Vec{0, 1, 0};
      if (joint.type != urdf::Joint::REVOLUTE || std::fabs(dot(axis, wanted) - 1.0) > 1e-6) {
        urdf.fail(fmt::format(
            "joint '{}' is not revolute about {}, as a leg of HAA (x), HFE (y), KFE (y) has it",
            joint_name, j == 0 ? "x" : "y"));
      }
      if (!joint.limits || !(joint.limits->lower < joint.limits->upper) ||
          !(joint.limits->effort > 0.0) || !(joint.limits->velocity > 0.0)) {
        urdf.fail(fmt::format("joint '{}' lacks limits lower < upper, effort > 0, velocity > 0",
                              joint_name));
      }
      origins[j] = to_vec(joint.parent_to_joint_origin_transform.position);
      const int i = 3 * l + j;
      m.lower_rad[i] = joint.limits->lower;
      m.upper_rad[i] = joint.limits->upper;
      m.torque_limit_nm[i] = joint.limits->effort;
      m.speed_limit_radps[i] = joint.limits->velocity;
      m.rotor_inertia[i] = rotor;
      robot.nominal_rad[i] = nominal[j];
      robot.lying_rad[i] = lying[j];
      parent = child;
    }
    leg.haa = origins[0];
    leg.hfe = origins[1];
    leg.kfe = origins[2];
    leg.hip = urdf.body(with_leg(link_names[0], leg_names[l]));
    leg.thigh = urdf.body(with_leg(link_names[1], leg_names[l]));
    const Body<double> shank = urdf.body(parent);
    const std::string foot_link = with_leg(foot_pattern, leg_names[l]);
    const urdf::Link& foot = urdf.link(foot_link);
    if (!foot.parent_joint || foot.parent_joint->type != urdf::Joint::FIXED) {
      urdf.fail(fmt::format("link '{}' is not fixed to '{}'", foot_link, parent));
    }
    leg.foot = to_vec(urdf.joint(foot.parent_joint->name, parent, foot_link)
                          .parent_to_joint_origin_transform.position);
    leg.shank = merged(shank, urdf.body(foot_link), leg.foot);
    double radius = 0.0, width = 0.0;
    if (const auto* tyre =
            urdf.shape<urdf::Cylinder>(foot_link, urdf::Geometry::CYLINDER, nullptr)) {
      radius = tyre->radius;
      width = tyre->length;
    } else if (const auto* ball =
                   urdf.shape<urdf::Sphere>(foot_link, urdf::Geometry::SPHERE, nullptr)) {
      radius = ball->radius;
    }
    if (!(radius > 0.0))
      urdf.fail(fmt::format("link '{}' has no collision cylinder or sphere", foot_link));
    m.foot_radius_m = radius;
    m.foot_width_m = width;
  }
  urdf.refuse_other_masses();
  robot.nominal_height_m =
      nominal_height > 0.0 ? nominal_height : standing_height(m, robot.nominal_rad);
  robot.lying_height_m = standing_height(m, robot.lying_rad);
  robot.description.urdf = urdf_text;
  robot.description.base_link = base;
  robot.description.leg_names = leg_names;
  return robot;
}

Robot load_robot(const std::string& map_path) {
  const std::string map_text = read_text(map_path);
  ConfigTree map;
  map.add_text(map_text, map_path);
  const std::string urdf = map.text("urdf", "robot.urdf");
  const std::string urdf_path =
      (std::filesystem::path(map_path).parent_path() / urdf).lexically_normal().string();
  return parse_robot(map_text, map_path, read_text(urdf_path), urdf_path);
}

Robot load_raibo() {
  return parse_robot(std::string(embedded_robot_file("raibo.toml")), "raibo.toml",
                     std::string(embedded_robot_file("raibo.urdf")), "raibo.urdf");
}

}  // namespace sandrunner::sim
