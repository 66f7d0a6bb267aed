// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/ros_description.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>

#include "rt/base/errors.h"

namespace sandrunner::sim {
namespace {

using Element = tinyxml2::XMLElement;

constexpr const char* kBaseLink = "base_link";  // REP 105
constexpr double kThinnestRod_m = 0.01;

bool is_identity(const urdf::Pose& pose) {
  const auto& p = pose.position;
  const auto& q = pose.rotation;
  return std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z) + std::fabs(q.x) + std::fabs(q.y) +
             std::fabs(q.z) <
         1e-9;
}

// The link "base_link" if it is at the place of the base: the base, or what it is fixed to.
const urdf::Link* base_link_above(const UrdfReader& urdf, const urdf::Link& base) {
  const urdf::Link* link = &base;
  while (link->name != kBaseLink) {
    if (!link->parent_joint || link->parent_joint->type != urdf::Joint::FIXED ||
        !is_identity(link->parent_joint->parent_to_joint_origin_transform)) {
      return nullptr;
    }
    link = &urdf.link(link->parent_joint->parent_link_name);
  }
  return link;
}

RobotFrame frame_of(const urdf::Joint& joint, const JointArray<std::string>& joint_names) {
  const urdf::Vector3& p = joint.parent_to_joint_origin_transform.position;
  const urdf::Rotation& q = joint.parent_to_joint_origin_transform.rotation;
  RobotFrame frame{.name = joint.child_link_name,
                   .parent = joint.parent_link_name,
                   .translation_m = {p.x, p.y, p.z},
                   .rotation_wxyz = {q.w, q.x, q.y, q.z}};
  if (joint.type == urdf::Joint::FIXED) return frame;
  const auto found = std::ranges::find(joint_names, joint.name);
  frame.joint = static_cast<int>(found - joint_names.begin());
  frame.axis = {joint.axis.x, joint.axis.y, joint.axis.z};
  return frame;
}

// Everything that hangs from `link`.
void add_frames_below(const urdf::Link& link, RobotDescription& description) {
  for (const auto& joint : link.child_joints) {
    description.frames.push_back(frame_of(*joint, description.joint_names));
  }
  for (const auto& child : link.child_links) add_frames_below(*child, description);
}

std::vector<OutlinePoint> outline_of(const RobotModel<double>& model, const std::string& base,
                                     const std::array<LegLinks, kNumLegs>& legs) {
  std::vector<OutlinePoint> outline;
  for (const LegLinks& leg : legs) {
    outline.push_back({leg.foot, leg.foot_centre_m, model.foot_radius_m});
    outline.push_back({leg.shank, {}, model.knee_radius_m});  // its origin is the knee
  }
  const Vec3<double>&centre = model.base_box_centre_m, &half = model.base_box_half_m;
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = [corner](int axis, double c, double h) {
      return (corner >> axis & 1) == 0 ? c - h : c + h;
    };
    outline.push_back(
        {base, {at(0, centre.x, half.x), at(1, centre.y, half.y), at(2, centre.z, half.z)}});
  }
  return outline;
}

// The URDF's text with these changes.
class UrdfText {
 public:
  /// `name` stands for the text in errors.
  UrdfText(const std::string& text, const std::string& name) {
    document_.Parse(text.c_str());
    robot_ = document_.FirstChildElement("robot");
    if (document_.Error() || !robot_) {
      throw InputError(fmt::format("{}: not a valid URDF: line {}: {}", name,
                                   document_.ErrorLineNum(), document_.ErrorName()));
    }
  }

  void add_root(const std::string& base) {
    robot_->InsertNewChildElement("link")->SetAttribute("name", kBaseLink);
    Element& joint = *robot_->InsertNewChildElement("joint");
    joint.SetAttribute("name", fmt::format("{}_to_{}", kBaseLink, base).c_str());
    joint.SetAttribute("type", "fixed");
    joint.InsertNewChildElement("parent")->SetAttribute("link", kBaseLink);
    joint.InsertNewChildElement("child")->SetAttribute("link", base.c_str());
  }

  bool has_visuals() const {
    bool has = false;
    for_each_link([&](const Element& link) { has = has || link.FirstChildElement("visual"); });
    return has;
  }

  /// `rod_radius_m`: of the rods in a link with this name.
  template <typename Radius>
  void add_visuals(const UrdfReader& urdf, const Radius& rod_radius_m) {
    for_each_link([&](Element& link) {
      const std::string name = link.Attribute("name");
      if (name == kBaseLink && urdf.model().links_.count(name) == 0) return;  // the new root
      const Element* collision = link.FirstChildElement("collision");
      for (; collision; collision = collision->NextSiblingElement("collision")) {
        Element& visual = add_copy(link, *collision);
        visual.SetName("visual");
        colour(visual);
      }
      if (link.FirstChildElement("visual")) return;
      for (const auto& joint : urdf.link(name).child_joints) {
        const urdf::Vector3& end = joint->parent_to_joint_origin_transform.position;
        add_rod(link, {end.x, end.y, end.z}, rod_radius_m(name));
      }
    });
  }

  std::string text() const {
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  template <typename Use>
  void for_each_link(const Use& use) const {
    Element* link = robot_->FirstChildElement("link");
    for (; link; link = link->NextSiblingElement("link")) use(*link);
  }

  /// A copy of `element`, of whatever document, as the last child.
  static Element& add_copy(Element& parent, const Element& element) {
    return *parent.InsertEndChild(element.DeepClone(parent.GetDocument()))->ToElement();
  }

  static Element& add(Element& parent, const std::string& text) {
    tinyxml2::XMLDocument part;
    part.Parse(text.c_str());
    return add_copy(parent, *part.FirstChildElement());
  }

  static void colour(Element& visual) {
    if (Element* const old = visual.FirstChildElement("material")) visual.DeleteChild(old);
    add(visual, R"(<material name="grey"><color rgba="0.6 0.6 0.6 1"/></material>)");
  }

  // From the origin to `end`.
  static void add_rod(Element& link, const Vector3& end, double radius_m) {
    const double length_m = std::hypot(end[0], end[1], end[2]);
    if (length_m < kThinnestRod_m) return;
    colour(add(link, fmt::format(R"(<visual><origin xyz="{} {} {}" rpy="0 {} {}"/><geometry>)"
                                 R"(<cylinder radius="{}" length="{}"/></geometry></visual>)",
                                 end[0] / 2, end[1] / 2, end[2] / 2, std::acos(end[2] / length_m),
                                 std::atan2(end[1], end[0]), radius_m, length_m)));
  }

  tinyxml2::XMLDocument document_;
  Element* robot_;
};

}  // namespace

void describe_for_ros(const UrdfReader& urdf, const std::string& base,
                      const std::array<LegLinks, kNumLegs>& legs, Robot& robot) {
  RobotDescription& description = robot.description;
  const urdf::Link& base_link = urdf.link(base);
  UrdfText text(description.urdf, description.name);
  if (const urdf::Link* const above = base_link_above(urdf, base_link)) {
    description.base_frame = kBaseLink;
    add_frames_below(*above, description);
  } else if (!base_link.parent_joint && urdf.model().links_.count(kBaseLink) == 0) {
    description.base_frame = kBaseLink;
    text.add_root(base);
    description.frames.push_back({.name = base, .parent = kBaseLink});
    add_frames_below(base_link, description);
  } else {
    description.base_frame = base;
    add_frames_below(base_link, description);
  }
  description.outline = outline_of(robot.model, base, legs);
  if (!text.has_visuals()) {
    text.add_visuals(urdf, [&](const std::string& link) {
      const bool is_shank =
          std::ranges::any_of(legs, [&](const LegLinks& leg) { return leg.shank == link; });
      return std::max(is_shank ? robot.model.shank_radius_m : robot.model.knee_radius_m,
                      kThinnestRod_m);
    });
  }
  description.ros_urdf = text.text();
}

}  // namespace sandrunner::sim
