// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "policy/network.h"
#include "policy/perceptron.h"
#include "rt/core/command_shaping.h"
#include "rt/core/robot_description.h"

namespace sandrunner {

/// Everything except the network that is needed to run a policy. README.md of this folder says how
/// a file holds it.
struct PolicySpec {
  std::string name;
  /// The robot's joints in the order of messages.h; all arrays of joints are in it.
  JointArray<std::string> joint_names;
  JointArray<double> nominal_position_rad{};
  JointArray<double> action_scale_rad{};
  /// Limit of |action|, before the scale; 0: none.
  double action_clip = 0.0;
  double kp_nmprad = 0.0;
  double kd_nmsprad = 0.0;
  double torque_limit_nm = 0.0;
  /// The yaw command is limited to this centripetal acceleration over the commanded speed.
  double yaw_command_clip_mps2 = 0.0;
  /// What it was trained for; kNarrowEnvelope if its file does not say.
  CommandEnvelope envelope = kNarrowEnvelope;
  bool has_envelope = false;  ///< the file has one
  /// Estimate in physical units = raw * sqrt(variance) + mean: body height (m), velocity (m/s),
  /// foot heights (m).
  std::array<float, kEstimateSize> estimate_mean{};
  std::array<float, kEstimateSize> estimate_variance{};
  /// Where the policy comes from: free text under free keys.
  std::map<std::string, std::string> provenance;
};

/// Whether all joints have the same action scale.
bool has_one_scale(const PolicySpec& spec);

/// Throws InputError unless the policy is for a robot with these joints, in the same order.
void require_joints(const PolicySpec& spec, const RobotDescription& robot);

/// What one step of the policy yields.
struct PolicyStep {
  /// Joint targets: nominal position + action scale * limited action.
  JointArray<double> target_rad{};
  StateEstimate estimate;  ///< NaN: what the network does not estimate
};

/// The step that a network's answer means. Real-time safe.
PolicyStep policy_step(const PolicySpec& spec, const std::array<float, kNumJoints>& action,
                       const std::array<float, kEstimateSize>& estimate_raw) noexcept;

/// A policy that runs: network, its state, and the units around it. `load_policy` (policy_file.h)
/// makes one.
class Policy {
 public:
  Policy(PolicySpec spec, std::variant<Network, Perceptron> network)
      : spec_(std::move(spec)), network_(std::move(network)) {}

  /// Clears the memory of the network, as before its first step.
  void reset() noexcept { state_ = {}; }

  /// One step at kPolicyHz. `observation` is raw; estimator/observation.h builds it. Real-time
  /// safe. NaN in, NaN out, until reset().
  PolicyStep step(const std::array<float, kObservationSize>& observation) noexcept {
    return step(observation, state_);
  }
  /// The same with a memory of the caller's: for many robots.
  PolicyStep step(const std::array<float, kObservationSize>& observation,
                  NetworkState& state) const noexcept {
    NetworkOutput output;
    std::visit([&](const auto& network) { network.step(observation, state, output); }, network_);
    return policy_step(spec_, output.action, output.estimate_raw);
  }

  /// Brings the network's weights into the core's caches, ahead of a step. Real-time safe.
  void touch_weights() const noexcept {
    std::visit([](const auto& network) { network.touch_weights(); }, network_);
  }

  /// All that a step depends on besides its input: for snapshots and hashes.
  const NetworkState& state() const noexcept { return state_; }
  void set_state(const NetworkState& state) noexcept { state_ = state; }

  const PolicySpec& spec() const noexcept { return spec_; }

 private:
  PolicySpec spec_;
  std::variant<Network, Perceptron> network_;
  NetworkState state_;
};

}  // namespace sandrunner
