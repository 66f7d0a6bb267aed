// SPDX-License-Identifier: BSD-3-Clause
// Learner: to and from a checkpoint.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "rt/base/errors.h"
#include "tools/train/learner/learner.h"

namespace sandrunner::learner {
namespace {

std::string join(const std::vector<int>& widths) {
  std::string text;
  for (const int width : widths) text += fmt::format("{}{}", text.empty() ? "" : "-", width);
  return text;
}

}  // namespace

std::string Learner::architecture() const {
  const NetworkSizes& network = config_.network;
  return fmt::format("envs {} of {}, privileged {}, hidden {}, estimator {}, actor {}, critic {}{}",
                     rollout_.shape.envs, config_.block_envs, rollout_.shape.privileged,
                     network.hidden, join(network.estimator), join(network.actor),
                     join(network.critic),
                     network.wiring == Wiring{} ? "" : ", " + wiring_text(network.wiring));
}

void Learner::save(Checkpoint& checkpoint) const {
  checkpoint.architecture = architecture();
  Counters counters = counters_;
  counters.adam_steps = adam_.step;
  checkpoint.put("learner.counters", &counters, 1);
  checkpoint.put("learner.parameters", parameters_.data(), parameters_.size());
  checkpoint.put("learner.averaged", averaged_.data(), averaged_.size());
  checkpoint.put("learner.adam_m", adam_.m.data(), adam_.m.size());
  checkpoint.put("learner.adam_v", adam_.v.data(), adam_.v.size());
  checkpoint.put_envs("learner.memory", memory_.data(), static_cast<std::size_t>(memory_.size()));
  checkpoint.put_envs("learner.mirror_memory", mirror_memory_.data(),
                      static_cast<std::size_t>(mirror_memory_.size()));
  if (teacher_) {
    checkpoint.put("learner.teacher", &teacher_->hash, 1);
    checkpoint.put_envs("learner.teacher_memory", teacher_->memory.data(),
                        static_cast<std::size_t>(teacher_->memory.size()));
  }
  checkpoint.put_envs("learner.asymmetry", asymmetry_.data(),
                      static_cast<std::size_t>(asymmetry_.size()));
  checkpoint.put("learner.reset", &rollout_.reset(0, 0),
                 static_cast<std::size_t>(rollout_.shape.envs));
  const auto put_first_step = [&](const std::string& name, const auto& field) {
    const auto columns = field(0);
    checkpoint.put(name, columns.data(), static_cast<std::size_t>(columns.size()));
  };
  put_first_step("learner.observation", rollout_.observation);
  put_first_step("learner.privileged", rollout_.privileged);
  put_first_step("learner.estimate_target", rollout_.estimate_target);
  put_first_step("learner.insight", rollout_.insight);
}

void Learner::load(const Checkpoint& checkpoint) {
  if (checkpoint.architecture != architecture()) {
    throw InputError(fmt::format("{}: checkpoint is for {}; expected {}", checkpoint.source,
                                 checkpoint.architecture, architecture()));
  }
  Counters counters;
  checkpoint.get("learner.counters", &counters, 1);
  checkpoint.get("learner.parameters", parameters_.data(), parameters_.size());
  checkpoint.get("learner.averaged", averaged_.data(), averaged_.size());
  checkpoint.get("learner.adam_m", adam_.m.data(), adam_.m.size());
  checkpoint.get("learner.adam_v", adam_.v.data(), adam_.v.size());
  checkpoint.get("learner.memory", memory_.data(), static_cast<std::size_t>(memory_.size()));
  checkpoint.get("learner.mirror_memory", mirror_memory_.data(),
                 static_cast<std::size_t>(mirror_memory_.size()));
  if (teacher_) {
    std::uint64_t hash = 0;
    checkpoint.get("learner.teacher", &hash, 1);
    if (hash != teacher_->hash) {
      throw InputError(fmt::format(
          "{}: found another teacher than this; continue with the same one", checkpoint.source));
    }
    checkpoint.get("learner.teacher_memory", teacher_->memory.data(),
                   static_cast<std::size_t>(teacher_->memory.size()));
  }
  checkpoint.get("learner.asymmetry", asymmetry_.data(),
                 static_cast<std::size_t>(asymmetry_.size()));
  checkpoint.get("learner.reset", &rollout_.reset(0, 0),
                 static_cast<std::size_t>(rollout_.shape.envs));
  const auto get_first_step = [&](const std::string& name, auto& field) {
    auto columns = field(0);
    checkpoint.get(name, columns.data(), static_cast<std::size_t>(columns.size()));
  };
  get_first_step("learner.observation", rollout_.observation);
  get_first_step("learner.privileged", rollout_.privileged);
  get_first_step("learner.estimate_target", rollout_.estimate_target);
  get_first_step("learner.insight", rollout_.insight);
  counters_ = counters;
  adam_.step = counters.adam_steps;
  begin_window();
}

}  // namespace sandrunner::learner
