// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/urdf_legs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "rt/base/errors.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;
using Chain = std::vector<const urdf::Joint*>;

bool moves(const urdf::Joint& joint) {
  return joint.type != urdf::Joint::FIXED && joint.type != urdf::Joint::FLOATING;
}

/// The moving joints below a link and what is fixed to it.
void add_moving(const UrdfReader& urdf, const urdf::Link& link, Chain& found) {
  for (const auto& joint : link.child_joints) {
    if (moves(*joint)) {
      found.push_back(joint.get());
    } else {
      add_moving(urdf, urdf.link(joint->child_link_name), found);
    }
  }
}

/// A joint and those that follow it, one behind the other; empty if they branch.
Chain chain_from(const UrdfReader& urdf, const urdf::Joint& first) {
  Chain chain{&first};
  while (true) {
    Chain next;
    add_moving(urdf, urdf.link(chain.back()->child_link_name), next);
    if (next.empty()) return chain;
    if (next.size() > 1) return {};
    chain.push_back(next.front());
  }
}

std::vector<Chain> legs_in(const UrdfReader& urdf) {
  Chain first;
  add_moving(urdf, *urdf.model().getRoot(), first);
  std::vector<Chain> legs;
  std::vector<std::string> found;
  for (const urdf::Joint* joint : first) {
    const Chain chain = chain_from(urdf, *joint);
    found.push_back(
        fmt::format("'{}' and {} behind it", joint->name,
                    chain.empty() ? std::string("a branch") : std::to_string(chain.size() - 1)));
    if (chain.size() == kJointsPerLeg) legs.push_back(chain);
  }
  if (legs.size() != kNumLegs || first.size() != kNumLegs) {
    urdf.fail(fmt::format("found joints at the base: {}; expected four legs of three joints",
                          found.empty() ? "none" : fmt::format("{}", fmt::join(found, ", "))));
  }
  return legs;
}

/// The link that carries all legs, or to which their carriers are fixed.
std::string base_of(const UrdfReader& urdf, const std::vector<Chain>& legs) {
  const std::string& first = legs[0][0]->parent_link_name;
  const bool same = std::ranges::all_of(
      legs, [&](const Chain& leg) { return leg[0]->parent_link_name == first; });
  return same ? first : urdf.model().getRoot()->name;
}

/// Links that are fixed to `link`, and where they are from its origin (base axes).
void add_fixed(const UrdfReader& urdf, const std::string& shank, const urdf::Link& link,
               std::vector<std::pair<std::string, Vec>>& found) {
  for (const auto& joint : link.child_joints) {
    if (joint->type != urdf::Joint::FIXED) continue;
    Vec place, axis;
    urdf.joint(joint->name, shank, joint->child_link_name, place, axis);
    found.emplace_back(joint->child_link_name, place);
    add_fixed(urdf, shank, urdf.link(joint->child_link_name), found);
  }
}

/// The fixed link that is the foot: one with a round shape, or else the one furthest from the knee,
/// with a box or none.
std::string foot_of(const UrdfReader& urdf, const std::string& shank, LegGeometry& leg,
                    bool& has_shape) {
  std::vector<std::pair<std::string, Vec>> links;
  add_fixed(urdf, shank, urdf.link(shank), links);
  if (links.empty()) {
    urdf.fail(fmt::format("no link is fixed to '{}': found no foot; add a link at its end, fixed",
                          shank));
  }
  std::string best;
  double best_reach = -1.0;
  bool best_is_round = false;
  for (const auto& [name, place] : links) {
    UrdfFoot foot;
    bool shaped = true;
    try {
      foot = urdf.foot(name, place);
    } catch (const InputError&) {
      shaped = false;
    }
    const bool round = shaped && foot.length_m == 0.0;
    const Vec centre = place + foot.centre_m;
    const double reach = std::hypot(centre.x, centre.z);
    if (round < best_is_round || (round == best_is_round && reach <= best_reach)) continue;
    best_is_round = round;
    has_shape = shaped;
    best = name;
    best_reach = reach;
    leg.foot = centre;
    leg.foot_radius_m = foot.radius_m;
  }
  return best;
}

/// A leg but for its foot.
LegGeometry geometry_of(const UrdfReader& urdf, std::string parent, const Chain& leg) {
  LegGeometry g;
  Vec* const places[] = {&g.haa, &g.hfe, &g.kfe};
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    Vec axis;
    const urdf::Joint& joint =
        urdf.joint(leg[j]->name, parent, leg[j]->child_link_name, *places[j], axis);
    g.sign[j] = std::copysign(1.0, j == 0 ? axis.x : axis.y);
    const bool stops = joint.type == urdf::Joint::REVOLUTE && joint.limits;
    g.lower_rad[j] = stops ? joint.limits->lower : kFreeStops_rad[j][0];
    g.upper_rad[j] = stops ? joint.limits->upper : kFreeStops_rad[j][1];
    urdf.check_stops(joint.name, g.lower_rad[j], g.upper_rad[j]);
    parent = joint.child_link_name;
  }
  return g;
}

}  // namespace

UrdfLegs find_legs(const std::string& text, const std::string& name) {
  const UrdfReader plain(text, name);
  std::vector<Chain> legs = legs_in(plain);
  UrdfLegs found;
  found.base = base_of(plain, legs);
  const UrdfReader urdf(text, name, found.base);
  found.feet_have_shapes = true;
  std::vector<LegGeometry> geometry;
  std::vector<std::string> feet;
  for (const Chain& leg : legs) {
    bool has_shape = false;
    geometry.push_back(geometry_of(urdf, found.base, leg));
    feet.push_back(foot_of(urdf, leg.back()->child_link_name, geometry.back(), has_shape));
    found.feet_have_shapes = found.feet_have_shapes && has_shape;
  }
  Vec centre{};
  for (const LegGeometry& g : geometry) centre = centre + 0.25 * (g.haa + g.hfe);
  std::array<bool, kNumLegs> taken{};
  for (std::size_t i = 0; i < kNumLegs; ++i) {
    const Vec hip = geometry[i].haa + geometry[i].hfe;
    const std::size_t l = (hip.x < centre.x ? 2u : 0u) + (hip.y < centre.y ? 1u : 0u);
    if (taken[l]) {
      plain.fail(
          fmt::format("found two legs {}, expected one in each corner of the base, whose "
                      "front is x and whose left is y",
                      kLegKeys[l]));
    }
    taken[l] = true;
    for (const urdf::Joint* joint : legs[i]) found.joints[l].push_back(*joint);
    found.geometry[l] = geometry[i];
    found.foot[l] = feet[i];
  }
  return found;
}

}  // namespace sandrunner::sim
