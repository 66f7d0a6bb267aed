// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/new_robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

#include "rt/base/errors.h"
#include "sim/robot/leg_poses.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {
namespace {

using Vec = Vec3<double>;
using Chain = std::vector<const urdf::Joint*>;
using Texts = std::array<std::string, kNumLegs>;

constexpr const char* kLegKeys[] = {"left_front", "right_front", "left_hind", "right_hind"};

/// Largest torque and speed that a URDF may say in earnest; more stands for "no limit".
constexpr double kMostTorque_nm = 999.0, kMostSpeed_radps = 99.0;
/// The gate's own largest limits.
constexpr double kMostKp_nmprad = 1000.0, kMostKd_nmsprad = 50.0;
/// In a Stand that holds its pose, a knee gives way by this.
constexpr double kSag_rad = 0.05;

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

/// Everything that is found in a URDF, legs in the order LF, RF, LH, RH.
struct Found {
  std::string base;
  std::array<Chain, kNumLegs> legs;
  Texts foot;
  std::array<LegGeometry, kNumLegs> geometry;
};

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

/// The fixed link that is the foot: one with a round shape, or else the one furthest from the knee.
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
  has_shape = false;
  for (const auto& [name, place] : links) {
    UrdfFoot foot;
    bool round = true;
    try {
      foot = urdf.foot(name, place);
    } catch (const InputError&) {
      round = false;
    }
    const Vec centre = place + foot.centre_m;
    const double reach = std::hypot(centre.x, centre.z);
    if (round < has_shape || (round == has_shape && reach <= best_reach)) continue;
    has_shape = round;
    best = name;
    best_reach = reach;
    leg.foot = centre;
    leg.foot_radius_m = foot.radius_m;
  }
  return best;
}

Found find(const UrdfReader& plain, const std::string& text, const std::string& name,
           bool& feet_have_shapes) {
  std::vector<Chain> legs = legs_in(plain);
  Found found;
  found.base = base_of(plain, legs);
  const UrdfReader urdf(text, name, found.base);
  feet_have_shapes = true;
  std::vector<LegGeometry> geometry;
  std::vector<std::string> feet;
  for (const Chain& leg : legs) {
    LegGeometry g;
    std::string parent = found.base;
    Vec* const places[] = {&g.haa, &g.hfe, &g.kfe};
    for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
      Vec axis;
      const urdf::Joint& joint =
          urdf.joint(leg[j]->name, parent, leg[j]->child_link_name, *places[j], axis);
      g.sign[j] = std::copysign(1.0, j == 0 ? axis.x : axis.y);
      const bool stops = joint.type == urdf::Joint::REVOLUTE && joint.limits;
      g.lower_rad[j] = stops ? joint.limits->lower : kFreeStops_rad[j][0];
      g.upper_rad[j] = stops ? joint.limits->upper : kFreeStops_rad[j][1];
      parent = joint.child_link_name;
    }
    bool has_shape = false;
    feet.push_back(foot_of(urdf, parent, g, has_shape));
    feet_have_shapes = feet_have_shapes && has_shape;
    geometry.push_back(g);
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
    found.legs[l] = legs[i];
    found.geometry[l] = geometry[i];
    found.foot[l] = feet[i];
  }
  return found;
}

/// What differs between the names of four legs, to whole words: "FL" of "FL_hip_joint".
Texts tokens_of(const Texts& names) {
  std::size_t begin = 0, end = 0;
  const auto same = [&](auto character_of) {
    return std::ranges::all_of(names, [&](const std::string& name) {
      return character_of(name) == character_of(names[0]) && character_of(name) != '\0';
    });
  };
  while (same([&](const std::string& n) { return begin < n.size() ? n[begin] : '\0'; })) ++begin;
  while (same([&](const std::string& n) {
    return end + begin < n.size() ? n[n.size() - 1 - end] : '\0';
  })) {
    ++end;
  }
  const auto is_word = [](char c) { return c != '_' && c != '-' && c != '.'; };
  while (begin > 0 && is_word(names[0][begin - 1])) --begin;
  while (end > 0 && is_word(names[0][names[0].size() - end])) --end;
  Texts tokens;
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    tokens[l] = names[l].substr(begin, names[l].size() - begin - end);
  }
  return tokens;
}

/// The name of all four with {leg} for what differs, or, without such a pattern, the four.
std::string pattern_of(const Texts& names, const Texts& tokens) {
  Texts patterns;
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    patterns[l] = names[l];
    constexpr std::string_view kLeg = "{leg}";
    for (std::size_t at = 0;
         !tokens[l].empty() && (at = patterns[l].find(tokens[l], at)) != std::string::npos;
         at += kLeg.size()) {
      patterns[l].replace(at, tokens[l].size(), kLeg);
    }
  }
  const bool same =
      patterns[0].find("{leg}") != std::string::npos &&
      std::ranges::all_of(patterns, [&](const std::string& p) { return p == patterns[0]; });
  return same ? patterns[0] : fmt::format("{}", fmt::join(names, ", "));
}

double mass_of(const UrdfReader& urdf) {
  double mass = 0.0;
  for (const auto& [name, link] : urdf.model().links_) {
    if (link->inertial) mass += link->inertial->mass;
  }
  return mass;
}

std::string array_text(const auto& values) {
  std::vector<std::string> texts;
  for (const double v : values) texts.push_back(fmt::format("{:.3f}", v));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

/// Rows of the file, and the keys among them that are guesses.
class Rows {
 public:
  void table(const char* name) { text += fmt::format("\n[{}]\n", name_ = name); }
  void known(const char* key, const std::string& value) {
    text += fmt::format("{} = {}\n", key, value);
  }
  void guess(const char* key, const std::string& value, const char* of) {
    text += fmt::format("{} = {}  # GUESS: {}\n", key, value, of);
    guesses.push_back(fmt::format("{}.{}: {}", name_, key, of));
  }
  std::string text;
  std::vector<std::string> guesses;

 private:
  std::string name_;
};

std::string in_quotes(const std::string& text) { return fmt::format("\"{}\"", text); }

/// Of three joints the largest limit of their legs, or NaN where one has none in earnest.
LegJoints<double> limits_of(const Found& found, double urdf::JointLimits::*limit, double most) {
  LegJoints<double> result{};
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    for (const Chain& leg : found.legs) {
      const double value = leg[j]->limits ? (*leg[j]->limits).*limit : 0.0;
      const bool good = value > 0.0 && value <= most && !std::isnan(result[j]);
      result[j] = good ? std::max(result[j], value) : std::nan("");
    }
  }
  return result;
}

/// Those of a URDF where it has them, else `guess` for all.
LegJoints<double> limits_or_guess(Rows& rows, const char* key, const LegJoints<double>& limits,
                                  double guess, const char* of) {
  if (std::ranges::none_of(limits, [](double v) { return std::isnan(v); })) return limits;
  LegJoints<double> chosen = limits;
  for (double& v : chosen) v = std::isnan(v) ? guess : v;
  rows.guess(key, array_text(chosen), of);
  return chosen;
}

}  // namespace

NewRobot new_robot(const std::string& urdf_text, const std::string& urdf_name,
                   const std::string& urdf_path) {
  const UrdfReader plain(urdf_text, urdf_name);
  bool feet_have_shapes = false;
  const Found found = find(plain, urdf_text, urdf_name, feet_have_shapes);
  const UrdfReader urdf(urdf_text, urdf_name, found.base);
  const LegGeometry& first = found.geometry[0];
  const double thigh_m = std::hypot(first.kfe.x, first.kfe.z);
  const double shank_m = std::hypot(first.foot.x, first.foot.z);
  const double weight_n = 9.81 * mass_of(urdf);

  Rows rows;
  rows.known("name", in_quotes(std::filesystem::path(urdf_path).stem().string()));
  rows.known("urdf", in_quotes(urdf_path));
  rows.table("legs");
  Texts names;
  const auto names_of = [&](auto name_of) {
    for (std::size_t l = 0; l < kNumLegs; ++l) names[l] = name_of(l);
    return names;
  };
  Texts tokens = tokens_of(names_of([&](std::size_t l) { return found.legs[l][0]->name; }));
  if (pattern_of(names_of([&](std::size_t l) { return found.legs[l][2]->name; }), tokens)
          .find(',') != std::string::npos) {
    tokens = {"LF", "RF", "LH", "RH"};
  }
  for (std::size_t l = 0; l < kNumLegs; ++l) rows.known(kLegKeys[l], in_quotes(tokens[l]));
  rows.table("joints");
  constexpr const char* kJointKeys[] = {"haa", "hfe", "kfe"};
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    names_of([&](std::size_t l) { return found.legs[l][j]->name; });
    rows.known(kJointKeys[j], in_quotes(pattern_of(names, tokens)));
  }
  const LegJoints<double> torque_nm = limits_or_guess(
      rows, "torque_limit_nm", limits_of(found, &urdf::JointLimits::effort, kMostTorque_nm),
      2.0 * weight_n * (thigh_m + shank_m) / 4.0,
      "the URDF has no effort; data sheet of the drive");
  const LegJoints<double> speed_radps = limits_or_guess(
      rows, "speed_limit_radps", limits_of(found, &urdf::JointLimits::velocity, kMostSpeed_radps),
      20.0, "the URDF has no velocity; data sheet of the drive");
  bool is_free = false;
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    is_free = is_free || found.legs[0][j]->type == urdf::Joint::CONTINUOUS;
  }
  if (is_free) {
    rows.guess("lower_rad", array_text(first.lower_rad),
               "joints turn for ever; where a leg touches");
    rows.guess("upper_rad", array_text(first.upper_rad), "the same");
  }
  LegJoints<double> rotor = torque_nm;
  for (double& v : rotor) v *= 2e-4;
  rows.guess("rotor_inertia_kgm2",
             fmt::format("[{:.2g}, {:.2g}, {:.2g}]", rotor[0], rotor[1], rotor[2]),
             "rotor inertia times gear ratio squared");
  rows.table("links");
  rows.known("base", in_quotes(found.base));
  constexpr const char* kLinkKeys[] = {"hip", "thigh", "shank"};
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    names_of([&](std::size_t l) { return found.legs[l][j]->child_link_name; });
    rows.known(kLinkKeys[j], in_quotes(pattern_of(names, tokens)));
  }
  rows.known("foot", in_quotes(pattern_of(found.foot, tokens)));

  rows.table("collision");
  double foot_radius_m = first.foot_radius_m;
  if (!feet_have_shapes) {
    foot_radius_m = 0.1 * shank_m;
    rows.guess("foot_radius_m", fmt::format("{:.3f}", foot_radius_m), "the URDF has no round foot");
  }
  double belly_m = 0.0;  // of the base's lowest part, from its origin
  if (const std::optional<UrdfBox> box = urdf.box()) {
    belly_m = box->centre_m.z - box->half_m.z;
  } else {
    const Vec across = found.geometry[0].haa - found.geometry[3].haa;
    const std::array edges{std::fabs(across.x), std::fabs(across.y), 0.4 * thigh_m};
    rows.guess("base_box_m", array_text(edges), "the URDF has no box; its belly is what counts");
    belly_m = -edges[2] / 2.0;
  }
  rows.guess("knee_radius_m", fmt::format("{:.3f}", 0.08 * thigh_m), "half the thigh's thickness");
  rows.guess("shank_radius_m", fmt::format("{:.3f}", 0.05 * shank_m), "half the shank's thickness");

  const LegPoses poses = leg_poses(urdf, found.geometry, belly_m, foot_radius_m);
  rows.table("pose");
  rows.guess("nominal_rad", array_text(poses.nominal_rad),
             "feet under the HFE axes, half stretched");
  rows.guess("lying_rad", array_text(poses.lying_rad), "as the robot lies when it is switched on");
  rows.guess("fold_rad", array_text(poses.fold_rad), "folded as far as legs and stops allow");

  // The load of a knee over what it may give way.
  const double kp = std::min(weight_n / 4.0 * poses.knee_lever_m / kSag_rad, kMostKp_nmprad);
  const double kd = std::min(0.03 * kp, 0.5 * kMostKd_nmsprad);
  const auto with_point = [&](double v) {
    const std::string text = fmt::format("{:.4g}", v);
    return text.find('.') == std::string::npos ? text + ".0" : text;
  };
  rows.table("gains");
  rows.guess("stand_kp_nmprad", with_point(kp), "a knee gives way by 0.05 rad");
  rows.guess("stand_kd_nmsprad", with_point(kd), "3 % of it");
  rows.guess("damping_kd_nmsprad", with_point(std::min(2.0 * kd, kMostKd_nmsprad)),
             "the robot sinks within a second");
  rows.guess("kp_limit_nmprad", with_point(std::min(2.0 * kp, kMostKp_nmprad)),
             "what the drives accept");
  rows.guess("kd_limit_nmsprad", with_point(std::min(4.0 * kd, kMostKd_nmsprad)),
             "what the drives accept");
  double power_w = 0.0;
  LegJoints<double> fault = speed_radps, stall = torque_nm, no_load = speed_radps,
                    continuous = torque_nm;
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    power_w += kNumLegs * torque_nm[j] * speed_radps[j] / 3.0;
    fault[j] *= 1.5;
    stall[j] *= 1.6;
    no_load[j] *= 1.1;
    continuous[j] /= 3.0;
  }
  rows.table("limits");
  rows.guess("speed_fault_radps", array_text(fault), "1.5 times the speed limit");
  rows.guess("power_w", fmt::format("{:.0f}.0", power_w), "battery voltage times its peak current");
  rows.table("motor");
  rows.guess("stall_torque_nm", array_text(stall), "V / R k n of the data sheet");
  rows.guess("no_load_speed_radps", array_text(no_load), "V / (k n) of the data sheet");
  rows.guess("continuous_torque_nm", array_text(continuous), "rated torque of the data sheet");
  rows.guess("thermal_time_s", "15.0", "how fast the windings warm");

  const std::string head = fmt::format(
      "# Robot file of {}, derived from its URDF. Every GUESS is for a person to check:\n"
      "# sim/robot/README.md says how to find each figure.\n",
      std::filesystem::path(urdf_path).stem().string());
  return {head + rows.text, rows.guesses};
}

}  // namespace sandrunner::sim
