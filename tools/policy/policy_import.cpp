// SPDX-License-Identifier: BSD-3-Clause
#include "tools/policy/policy_import.h"

#include <algorithm>
#include <filesystem>

#include "policy/perceptron_file.h"
#include "policy/policy_file.h"
#include "policy/spec_metadata.h"
#include "sim/robot/robot_model.h"
#include "tools/policy/description.h"

namespace sandrunner {
namespace {

/// What every import takes from its robot and its file.
void set_origin(const PolicyImport& given, const sim::Robot& robot, PolicySpec& spec) {
  spec.torque_limit_nm = *std::ranges::max_element(robot.model.torque_limit_nm);
  const std::filesystem::path input = given.input;
  spec.name = given.name.empty() ? input.stem().string() : given.name;
  spec.provenance["imported_from"] = input.filename().string();
}

/// Of a network of others, with the golden example that import_policy.py adds.
void import_perceptron(const PolicyImport& given, const sim::Robot& robot) {
  PerceptronFile file = read_description(given.observation, robot.description);
  take_bare_tensors(given.input, read_safetensors(given.input), file);
  PolicySpec& spec = file.spec;
  set_origin(given, robot, spec);
  TensorFile content = encode_perceptron(given.input, file);
  for (const std::string& assignment : given.assignments) {
    set_in_metadata(content.metadata, assignment);
    decode_perceptron("--set " + assignment, content);
  }
  write_safetensors(given.output, content);
}

}  // namespace

// What is not the robot's is as for the published network of Raibo (compliant-gym; Choi et al.
// 2023, "Controller structure").
void import_policy(const PolicyImport& given) {
  const sim::Robot robot = sim::load_robot(given.robot);
  if (!given.observation.empty()) return import_perceptron(given, robot);
  PolicyFile file = read_bare_weights(given.input);
  PolicySpec& spec = file.spec;
  spec.joint_names = robot.description.joint_names;
  spec.nominal_position_rad = robot.nominal_rad;
  spec.action_scale_rad.fill(0.3);
  spec.kp_nmprad = 50.0;
  spec.kd_nmsprad = 0.5;
  spec.yaw_command_clip_mps2 = 2.943;  // 0.3 g
  file.parameters.observation_clip = 10.0f;
  set_origin(given, robot, spec);
  for (const std::string& assignment : given.assignments) set_in_spec(file, assignment);
  file.golden = make_golden_example(file.parameters);
  write_policy_file(given.output, file);
}

}  // namespace sandrunner
