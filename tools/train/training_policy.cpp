// SPDX-License-Identifier: BSD-3-Clause
// Training: to and from a policy file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rt/base/errors.h"
#include "tools/train/policy_spec.h"
#include "tools/train/task/leg_modes.h"
#include "tools/train/training.h"

namespace sandrunner::train {
namespace {

/// Throws InputError unless weights of `policy` mean in a file with the scales of `ours` what they
/// mean in their own. Nominal positions may differ: angles are shown as what they are off them.
void require_scales(const PolicyFile& policy, const PolicyFile& ours) {
  const auto check = [&](const std::string& what, double is, double expected) {
    if (std::fabs(is - expected) <= 1e-4 * std::fabs(expected)) return;
    throw InputError(
        fmt::format("policy '{}': its {} is {:.6g}, expected {:.6g}, with which this trainer shows "
                    "and takes it",
                    policy.spec.name, what, is, expected));
  };
  const NetworkParameters &a = policy.parameters, &b = ours.parameters;
  constexpr std::size_t kAngles = 9;
  for (std::size_t i = 0; i < kObservationSize; ++i) {
    check(fmt::format("variance of observation {}", i), a.observation_variance[i],
          b.observation_variance[i]);
    if (i >= kAngles && i < kAngles + kNumJoints) continue;
    check(fmt::format("mean of observation {}", i), a.observation_mean[i], b.observation_mean[i]);
  }
  check("clip of observations", a.observation_clip, b.observation_clip);
  check("action scale", policy.spec.action_scale_rad, ours.spec.action_scale_rad);
  check("action clip", policy.spec.action_clip, ours.spec.action_clip);
}

}  // namespace

void Training::go_on_from(PolicyFile policy) {
  require_scales(policy, policy_file(snapshot(), learner_.averaged()));
  for (std::vector<float>* rows :
       {&policy.parameters.actor.back().weight, &policy.parameters.actor.back().bias}) {
    const std::vector<float> joints = *rows;
    modes_from_joints(config_.task.policy.mode_gain, joints.data(), joints.size() / kNumJoints,
                      rows->data());
  }
  std::vector<learner::PolicyTensor> tensors;
  for (const NamedTensor& tensor : tensors_of(policy.parameters)) {
    tensors.push_back({tensor.name, {}, *tensor.values});
  }
  learner_.set_policy(tensors);
  origin_ = fmt::format("sandrunner-train, from the weights of policy '{}'", policy.spec.name);
}

PolicyFile Training::policy_file(const Snapshot& snapshot,
                                 const std::vector<float>& parameters) const {
  PolicyFile file;
  CommandRange commands = task_.command_range();
  commands.forward_mps = snapshot.command_speed_mps;
  file.spec = policy_spec(config_.task, robot_, task_.scales(), commands);
  file.spec.provenance = {{"config", config_.effective},
                          {"robot", robot_.description.name},
                          {"seed", std::to_string(options_.seed)},
                          {"threads", std::to_string(options_.threads)},
                          {"transitions", fmt::format("{:.0f}", snapshot.transitions)},
                          {"core_hours", fmt::format("{:.3f}", snapshot.core_hours)},
                          {"processor", processors_},
                          {"commit", builds_},
                          {"origin", origin_}};
  NetworkParameters& p = file.parameters;
  set_normalisation(task_.scales(), p);
  const auto tensors = learner::policy_tensors(learner_.layout(), parameters);
  for (const NamedTensor& to : tensors_of(p)) {
    const auto from = std::ranges::find(tensors, to.name, &learner::PolicyTensor::name);
    if (from != tensors.end()) *to.values = from->values;
  }
  answer_in_joints(config_.task.policy.mode_gain, p);
  file.golden = make_golden_example(p);
  return file;
}

}  // namespace sandrunner::train
