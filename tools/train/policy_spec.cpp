// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/policy_spec.h"

#include <algorithm>

namespace sandrunner::train {

PolicySpec policy_spec(const TaskConfig& config, const sim::Robot& robot, const InputScales& scales,
                       const CommandRange& commands) {
  PolicySpec spec;
  spec.name = robot.description.name;
  spec.joint_names = robot.description.joint_names;
  spec.nominal_position_rad = robot.nominal_rad;
  spec.action_scale_rad.fill(config.policy.action_scale_rad);
  spec.action_clip = config.policy.action_clip;
  spec.kp_nmprad = config.policy.kp_nmprad;
  spec.kd_nmsprad = config.policy.kd_nmsprad;
  // One limit for all joints; where the robot's own are lower, they hold besides.
  spec.torque_limit_nm = *std::ranges::max_element(robot.model.torque_limit_nm);
  spec.yaw_command_clip_mps2 = config.command.centripetal_mps2;
  spec.envelope = {.forward_mps = commands.forward_mps,
                   .backward_mps = commands.backward_mps,
                   .lateral_mps = commands.lateral_mps,
                   .yaw_radps = commands.yaw_radps,
                   .acceleration_mps2 = config.command.acceleration_mps2,
                   .yaw_acceleration_radps2 = config.command.yaw_acceleration_radps2};
  spec.has_envelope = true;
  for (int i = 0; i < kEstimateSize; ++i) {
    spec.estimate_mean[i] = scales.estimate_mean[i];
    spec.estimate_variance[i] = scales.estimate_deviation[i] * scales.estimate_deviation[i];
  }
  return spec;
}

void set_normalisation(const InputScales& scales, NetworkParameters& parameters) {
  parameters.observation_clip = scales.clip;
  parameters.observation_mean.assign(scales.mean.begin(), scales.mean.end());
  parameters.observation_variance.clear();
  for (const float d : scales.inverse_deviation) {
    parameters.observation_variance.push_back(1.0f / (d * d) - 1e-8f);  // the network adds 1e-8
  }
}

}  // namespace sandrunner::train
