// SPDX-License-Identifier: BSD-3-Clause
// Learner: to and from a checkpoint.
#include <fmt/ranges.h>

#include <string>

#include "rt/base/errors.h"
#include "tools/train/learner/learner.h"

namespace sandrunner::learner {

std::string Learner::architecture() const {
  const NetworkSizes& network = config_.network;
  return fmt::format("envs {} of {}, privileged {}, hidden {}, estimator {}, actor {}, critic {}{}",
                     rollout_.shape.envs, config_.block_envs, rollout_.shape.privileged,
                     network.hidden, fmt::join(network.estimator, "-"),
                     fmt::join(network.actor, "-"), fmt::join(network.critic, "-"),
                     network.wiring == Wiring{} ? "" : ", " + wiring_text(network.wiring));
}

// Shows every array of the state: name, first value, how many, whether they are of environments.
template <typename Self, typename Visit>
void Learner::visit_arrays(Self& self, const Visit& visit) {
  const auto show = [&](const char* name, auto&& values, bool of_envs = false) {
    visit(name, values.data(), static_cast<std::size_t>(values.size()), of_envs);
  };
  show("learner.parameters", self.parameters_);
  show("learner.averaged", self.averaged_);
  show("learner.adam_m", self.adam_.m);
  show("learner.adam_v", self.adam_.v);
  show("learner.memory", self.memory_, true);
  show("learner.mirror_memory", self.mirror_memory_, true);
  if (self.teacher_) show("learner.teacher_memory", self.teacher_->memory, true);
  show("learner.asymmetry", self.asymmetry_, true);
  auto& first = self.rollout_;
  visit("learner.reset", &first.reset(0, 0), static_cast<std::size_t>(first.shape.envs), false);
  show("learner.observation", first.observation(0));
  show("learner.privileged", first.privileged(0));
  show("learner.estimate_target", first.estimate_target(0));
  show("learner.insight", first.insight(0));
}

void Learner::save(Checkpoint& checkpoint) const {
  checkpoint.architecture = architecture();
  Counters counters = counters_;
  counters.adam_steps = adam_.step;
  checkpoint.put("learner.counters", &counters, 1);
  if (teacher_) checkpoint.put("learner.teacher", &teacher_->hash, 1);
  visit_arrays(*this, [&](const char* name, const auto* values, std::size_t count, bool of_envs) {
    of_envs ? checkpoint.put_envs(name, values, count) : checkpoint.put(name, values, count);
  });
}

void Learner::load(const Checkpoint& checkpoint) {
  if (checkpoint.architecture != architecture()) {
    throw InputError(fmt::format("{}: checkpoint is for {}; expected {}", checkpoint.source,
                                 checkpoint.architecture, architecture()));
  }
  if (teacher_) {
    std::uint64_t hash = 0;
    checkpoint.get("learner.teacher", &hash, 1);
    if (hash != teacher_->hash) {
      throw InputError(fmt::format(
          "{}: found another teacher than this; continue with the same one", checkpoint.source));
    }
  }
  Counters counters;
  checkpoint.get("learner.counters", &counters, 1);
  visit_arrays(*this, [&](const char* name, auto* values, std::size_t count, bool /*of_envs*/) {
    checkpoint.get(name, values, count);
  });
  counters_ = counters;
  adam_.step = counters.adam_steps;
  begin_window();
}

}  // namespace sandrunner::learner
