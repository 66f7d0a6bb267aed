// SPDX-License-Identifier: BSD-3-Clause
// Training: to and from a policy file.
#include <fmt/format.h>

#include <utility>

#include "rt/base/errors.h"
#include "tools/train/policy_spec.h"
#include "tools/train/task/leg_modes.h"
#include "tools/train/training.h"

namespace sandrunner::train {
void Training::go_on_from(PolicyFile policy) {
  const Wiring& wiring = config_.learner.network.wiring;
  if (!(policy.parameters.wiring == wiring)) {
    throw InputError(
        fmt::format("--from: found networks wired as '{}', expected '{}', as the "
                    "training's",
                    wiring_text(policy.parameters.wiring), wiring_text(wiring)));
  }
  require_scales(policy.spec, scales_of(policy.parameters), config_.task.policy, task_.scales());
  answer_in_modes(config_.task.policy.mode_gain, policy.parameters);
  learner_.set_policy(policy.parameters);
  origin_ = fmt::format("sandrunner-train, from the weights of policy '{}'", policy.spec.name);
}

// The policy imitates the networks of this file.
void Training::imitate(const std::string& teacher_file) {
  const TaskNetwork teacher =
      make_task_network(read_policy_file(teacher_file), config_.task.policy.mode_gain);
  require_scales(teacher.spec, teacher.scales, config_.task.policy, task_.scales());
  learner_.set_teacher(teacher.layout, teacher.parameters);
  origin_ = fmt::format("sandrunner-train, imitating '{}' of {} transitions", teacher.spec.name,
                        teacher.spec.provenance.at("transitions"));
}

PolicySpec Training::policy_spec(const Snapshot& snapshot) const {
  CommandRange commands = task_.command_range();
  commands.forward_mps = snapshot.command_speed_mps;
  PolicySpec spec = train::policy_spec(config_.task, robot_, task_.scales(), commands);
  spec.provenance = {{"config", config_.effective},
                     {"robot", robot_.description.name},
                     {"seed", std::to_string(options_.seed)},
                     {"threads", std::to_string(options_.threads)},
                     {"transitions", fmt::format("{:.0f}", snapshot.transitions)},
                     {"core_hours", fmt::format("{:.3f}", snapshot.core_hours)},
                     {"processor", processors_},
                     {"commit", builds_},
                     {"origin", origin_}};
  return spec;
}

PolicyFile Training::policy_file(PolicySpec spec, const std::vector<float>& parameters) const {
  PolicyFile file;
  file.spec = std::move(spec);
  NetworkParameters& p = file.parameters;
  set_normalisation(task_.scales(), p);
  learner::to_policy(learner_.layout(), parameters, p);
  answer_in_joints(config_.task.policy.mode_gain, p);
  file.golden = make_golden_example(p);
  return file;
}

}  // namespace sandrunner::train
