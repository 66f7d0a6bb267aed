// SPDX-License-Identifier: BSD-3-Clause
#include "tools/policy/description.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>
#include <vector>

#include "policy/text.h"
#include "rt/base/config_tree.h"
#include "tools/policy/embedded.h"

namespace sandrunner {
namespace {

constexpr std::string_view kEnding = ".toml";

JointArray<int> joints_of(const std::string& origin, std::string text,
                          const RobotDescription& robot) {
  std::ranges::replace(text, ',', ' ');
  std::istringstream words(text);
  const std::vector<std::string> names(std::istream_iterator<std::string>(words), {});
  JointArray<int> joint_of{};
  bool good = names.size() == kNumJoints;
  for (int j = 0; good && j < kNumJoints; ++j) {
    const auto found = std::ranges::find(robot.joint_names, names[static_cast<std::size_t>(j)]);
    good = found != robot.joint_names.end();
    joint_of[j] = static_cast<int>(found - robot.joint_names.begin());
  }
  JointArray<int> sorted = joint_of;
  std::ranges::sort(sorted);
  if (!good || std::ranges::adjacent_find(sorted) != sorted.end()) {
    throw InputError(fmt::format(
        "{}: joints: found '{}', expected each joint of robot '{}' once: {}", origin,
        printable(joined(names, ", "), 300), robot.name, joined(robot.joint_names, ", ")));
  }
  return joint_of;
}

}  // namespace

PerceptronFile read_description(const std::string& name_or_path, const RobotDescription& robot) {
  ConfigTree config;
  std::string origin = name_or_path;
  const std::string shipped = fmt::format("{}{}", name_or_path, kEnding);
  if (const std::string_view text = embedded_description(shipped); !text.empty()) {
    origin = "description " + name_or_path;
    config.add_text(text, origin);
  } else if (name_or_path.find_first_of("./") == std::string::npos) {
    std::vector<std::string> names = embedded_description_names();
    for (std::string& name : names) name.resize(name.size() - kEnding.size());
    throw InputError(fmt::format("--observation: found '{}', expected a file or one of {}",
                                 printable(name_or_path), joined(names, ", ")));
  } else {
    config.add_file(name_or_path);
  }
  for (const char* key : {"joints", "pose_rad", "observation", "kp_nmprad", "kd_nmsprad",
                          "action_scale_rad", "policy_hz"}) {
    if (!config.has(key))
      throw InputError(fmt::format("{}: found no '{}', expected it", origin, key));
  }
  PerceptronFile file;
  PerceptronParameters& p = file.parameters;
  PolicySpec& spec = file.spec;
  p.policy_hz = static_cast<int>(config.integer("policy_hz", 50, 1, kPolicyHz));
  p.activation = parse_activation(origin + ": activation", config.text("activation", "elu"));
  ObservationLayout& layout = p.observation;
  layout.terms = parse_terms(origin + ": observation", config.text("observation", ""));
  layout.clip = config.number("observation_clip", 0.0, 0.0, 1e6);
  layout.history = static_cast<int>(config.integer("history", 1, 1, 100));
  layout.order =
      parse_history_order(origin + ": history_order", config.text("history_order", "newest_first"));
  p.velocity_scale = config.number("estimator_velocity_scale", 1.0, 1e-3, 1e3);

  spec.joint_names = robot.joint_names;
  p.joint_of = joints_of(origin, config.text("joints", ""), robot);
  const std::vector<double> pose =
      config.numbers("pose_rad", std::vector<double>(kNumJoints, 0.0), kNumJoints, -7.0, 7.0);
  const std::vector<double> scale =
      config.repeated("action_scale_rad", std::vector<double>(kNumJoints, 0.25), 1, 1e-6, 100.0);
  for (int j = 0; j < kNumJoints; ++j) {
    spec.nominal_position_rad[p.joint_of[j]] = pose[static_cast<std::size_t>(j)];
    spec.action_scale_rad[p.joint_of[j]] = scale[static_cast<std::size_t>(j)];
  }
  spec.action_clip = config.number("action_clip", 0.0, 0.0, 1e6);
  spec.kp_nmprad = config.number("kp_nmprad", 20.0, 0.0, 1e4);
  spec.kd_nmsprad = config.number("kd_nmsprad", 0.5, 0.0, 1e3);
  spec.yaw_command_clip_mps2 = config.number("yaw_command_clip_mps2", 2.943, 1e-3, 100.0);
  config.reject_unknown();
  return file;
}

}  // namespace sandrunner
