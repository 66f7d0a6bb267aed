// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/new_robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "rt/base/errors.h"
#include "rt/base/toml_text.h"
#include "rt/core/gate_config.h"
#include "sim/robot/leg_poses.h"
#include "sim/robot/urdf_legs.h"
#include "sim/robot/urdf_reader.h"

namespace sandrunner::sim {
namespace {

using Texts = std::array<std::string, kNumLegs>;

/// Largest torque and speed that a URDF may say in earnest; more stands for "no limit".
constexpr double kMostTorque_nm = 999.0, kMostSpeed_radps = 99.0;
constexpr double kMostKp_nmprad = gate_threshold(&GateConfig::kp_limit_nmprad).ceiling;
constexpr double kMostKd_nmsprad = gate_threshold(&GateConfig::kd_limit_nmsprad).ceiling;
/// In a Stand that holds its pose, a knee gives way by this.
constexpr double kSag_rad = 0.05;

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

/// TOML: numbers with a point; an array of three or twelve.
std::string number_text(double value) {
  return fmt::format("{:.{}f}", value, value < 100.0 ? 3 : 1);
}
std::string array_text(const auto& values, int digits = 3) {
  std::vector<std::string> texts;
  for (const double v : values) texts.push_back(fmt::format("{:.{}f}", v, digits));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

LegJoints<double> scaled(LegJoints<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
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

/// Of three joints the largest limit of their legs, or NaN where one has none in earnest.
LegJoints<double> limits_of(const UrdfLegs& found, double urdf::JointLimits::* limit, double most) {
  LegJoints<double> result{};
  for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
    for (const auto& leg : found.joints) {
      const double value = leg[j].limits ? (*leg[j].limits).*limit : 0.0;
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

/// Writes the tables of a robot file, one after the other: each needs figures of those before.
class Draft {
 public:
  Draft(const UrdfReader& urdf, const UrdfLegs& legs)
      : urdf_(urdf),
        legs_(legs),
        thigh_m_(std::hypot(legs.geometry[0].kfe.x, legs.geometry[0].kfe.z)),
        shank_m_(std::hypot(legs.geometry[0].foot.x, legs.geometry[0].foot.z)),
        weight_n_(9.81 * mass_of(urdf)) {}

  NewRobot write(const std::string& urdf_path) {
    std::string name = std::filesystem::path(urdf_path).stem().string();
    replace_controls(name, '?');
    rows_.text = fmt::format(
        "# Robot file of {}, derived from its URDF. Every GUESS is for a person to check:\n"
        "# sim/robot/README.md says how to find each figure.\n",
        name);
    rows_.known("name", toml_quoted(name));
    rows_.known("urdf", toml_quoted(urdf_path));
    write_names();
    write_shapes();
    write_poses_and_gains();
    write_drives();
    return {rows_.text, rows_.guesses};
  }

 private:
  /// What `of` says of each leg's joint j.
  template <typename Of>
  Texts texts(std::size_t j, const Of& of) const {
    Texts all;
    for (std::size_t l = 0; l < kNumLegs; ++l) all[l] = of(legs_.joints[l][j]);
    return all;
  }
  Texts joints(std::size_t j) const {
    return texts(j, [](const urdf::Joint& joint) { return joint.name; });
  }

  void write_names() {
    Texts tokens = tokens_of(joints(0));
    if (pattern_of(joints(2), tokens).find(',') != std::string::npos) {
      tokens = {"LF", "RF", "LH", "RH"};
    }
    rows_.table("legs");
    for (std::size_t l = 0; l < kNumLegs; ++l) rows_.known(kLegKeys[l], toml_quoted(tokens[l]));
    rows_.table("links");
    rows_.known("base", toml_quoted(legs_.base));
    constexpr const char* kLinkKeys[] = {"hip", "thigh", "shank"};
    for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
      const Texts links = texts(j, [](const urdf::Joint& joint) { return joint.child_link_name; });
      rows_.known(kLinkKeys[j], toml_quoted(pattern_of(links, tokens)));
    }
    rows_.known("foot", toml_quoted(pattern_of(legs_.foot, tokens)));
    rows_.table("joints");
    constexpr const char* kJointKeys[] = {"haa", "hfe", "kfe"};
    for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
      rows_.known(kJointKeys[j], toml_quoted(pattern_of(joints(j), tokens)));
    }
    write_joint_limits();
  }

  void write_joint_limits() {
    torque_nm_ = limits_or_guess(rows_, "torque_limit_nm",
                                 limits_of(legs_, &urdf::JointLimits::effort, kMostTorque_nm),
                                 2.0 * weight_n_ * (thigh_m_ + shank_m_) / 4.0,
                                 "the URDF has no effort; data sheet of the drive");
    speed_radps_ = limits_or_guess(rows_, "speed_limit_radps",
                                   limits_of(legs_, &urdf::JointLimits::velocity, kMostSpeed_radps),
                                   20.0, "the URDF has no velocity; data sheet of the drive");
    const bool is_free = std::ranges::any_of(legs_.joints[0], [](const urdf::Joint& joint) {
      return joint.type == urdf::Joint::CONTINUOUS;
    });
    if (is_free) {
      LegJoints<double> lower = legs_.geometry[0].lower_rad, upper = legs_.geometry[0].upper_rad;
      for (const LegGeometry& leg : legs_.geometry) {
        for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
          lower[j] = std::max(lower[j], leg.lower_rad[j]);
          upper[j] = std::min(upper[j], leg.upper_rad[j]);
        }
      }
      rows_.guess("lower_rad", array_text(lower), "joints turn for ever; where a leg touches");
      rows_.guess("upper_rad", array_text(upper), "the same");
    }
    rows_.guess("rotor_inertia_kgm2", array_text(scaled(torque_nm_, 2e-4), 4),
                "rotor inertia times gear ratio squared");
  }

  void write_shapes() {
    rows_.table("collision");
    foot_radius_m_ = legs_.geometry[0].foot_radius_m;
    if (!legs_.feet_have_shapes) {
      foot_radius_m_ = 0.1 * shank_m_;
      rows_.guess("foot_radius_m", fmt::format("{:.3f}", foot_radius_m_),
                  "the URDF has no round foot");
    }
    if (const std::optional<UrdfBox> box = urdf_.box()) {
      belly_m_ = box->centre_m.z - box->half_m.z;
    } else {
      const Vec3<double> across = legs_.geometry[0].haa - legs_.geometry[3].haa;
      const std::array edges{std::fabs(across.x), std::fabs(across.y), 0.4 * thigh_m_};
      rows_.guess("base_box_m", array_text(edges), "the URDF has no box; its belly is what counts");
      belly_m_ = -edges[2] / 2.0;
    }
    rows_.guess("knee_radius_m", fmt::format("{:.3f}", 0.08 * thigh_m_),
                "half the thigh's thickness");
    rows_.guess("shank_radius_m", fmt::format("{:.3f}", 0.05 * shank_m_),
                "half the shank's thickness");
  }

  void write_poses_and_gains() {
    const LegPoses poses = leg_poses(urdf_, legs_.geometry, belly_m_, foot_radius_m_);
    rows_.table("pose");
    rows_.guess("nominal_rad", array_text(poses.nominal_rad),
                "feet under the HFE axes, half stretched");
    rows_.guess("lying_rad", array_text(poses.lying_rad),
                "as the robot lies when it is switched on");
    rows_.guess("fold_rad", array_text(poses.fold_rad), "folded as far as legs and stops allow");
    // The load of a knee over what it may give way.
    const double kp = std::min(weight_n_ / 4.0 * poses.knee_lever_m / kSag_rad, kMostKp_nmprad);
    const double kd = std::min(0.03 * kp, 0.5 * kMostKd_nmsprad);
    rows_.table("gains");
    rows_.guess("stand_kp_nmprad", number_text(kp), "a knee gives way by 0.05 rad");
    rows_.guess("stand_kd_nmsprad", number_text(kd), "3 % of it");
    rows_.guess("damping_kd_nmsprad", number_text(std::min(2.0 * kd, kMostKd_nmsprad)),
                "the robot sinks within a second");
    rows_.guess("kp_limit_nmprad", number_text(std::min(2.0 * kp, kMostKp_nmprad)),
                "what the drives accept");
    rows_.guess("kd_limit_nmsprad", number_text(std::min(4.0 * kd, kMostKd_nmsprad)),
                "what the drives accept");
  }

  void write_drives() {
    double power_w = 0.0;
    for (std::size_t j = 0; j < kJointsPerLeg; ++j) {
      power_w += kNumLegs * torque_nm_[j] * speed_radps_[j] / 3.0;
    }
    rows_.table("limits");
    rows_.guess("speed_fault_radps", array_text(scaled(speed_radps_, 1.5)),
                "1.5 times the speed limit");
    rows_.guess("power_w", number_text(power_w), "battery voltage times its peak current");
    rows_.table("motor");
    rows_.guess("stall_torque_nm", array_text(scaled(torque_nm_, 1.6)),
                "V / R k n of the data sheet");
    rows_.guess("no_load_speed_radps", array_text(scaled(speed_radps_, 1.1)),
                "V / (k n) of the data sheet");
    rows_.guess("continuous_torque_nm", array_text(scaled(torque_nm_, 1.0 / 3.0)),
                "rated torque of the data sheet");
    rows_.guess("thermal_time_s", "15.0", "how fast the windings warm");
  }

  const UrdfReader& urdf_;
  const UrdfLegs& legs_;
  const double thigh_m_, shank_m_, weight_n_;
  Rows rows_;
  LegJoints<double> torque_nm_{}, speed_radps_{};
  double foot_radius_m_ = 0.0;
  double belly_m_ = 0.0;  ///< of the base's lowest part, from its origin
};

}  // namespace

NewRobot new_robot(const std::string& urdf_text, const std::string& urdf_name,
                   const std::string& urdf_path) {
  const UrdfLegs legs = find_legs(urdf_text, urdf_name);
  const UrdfReader urdf(urdf_text, urdf_name, legs.base);
  return Draft(urdf, legs).write(urdf_path);
}

}  // namespace sandrunner::sim
