// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/model/task_network.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <utility>

#include "rt/base/errors.h"
#include "tools/train/task/leg_modes.h"

namespace sandrunner::train {

ObservationScales scales_of(const NetworkParameters& parameters) {
  return {parameters.observation_mean, parameters.observation_variance,
          parameters.observation_clip};
}

learner::ParameterLayout model_layout(const Wiring& wiring) {
  learner::NetworkSizes sizes;
  sizes.critic = {};
  sizes.wiring = wiring;
  return {sizes, 1};
}

TaskNetwork make_task_network(PolicyFile file, const std::array<double, kNumLegs>& mode_gain) {
  answer_in_modes(mode_gain, file.parameters);
  TaskNetwork network{
      std::move(file.spec), scales_of(file.parameters), model_layout(file.parameters.wiring), {}};
  network.parameters.assign(static_cast<std::size_t>(network.layout.size()), 0.0f);
  learner::from_policy(file.parameters, network.layout, network.parameters);
  return network;
}

void require_scales(const PolicySpec& spec, const ObservationScales& network,
                    const PolicySettings& task, const InputScales& task_scales) {
  const auto check = [&](const std::string& what, double is, double expected) {
    if (std::fabs(is - expected) <= 1e-4 * std::fabs(expected)) return;
    throw InputError(
        fmt::format("policy '{}': its {} is {:.6g}, expected {:.6g}, with which this trainer shows "
                    "and takes it",
                    spec.name, what, is, expected));
  };
  constexpr int kAngles = 9;
  for (int i = 0; i < kObservationSize; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double deviation = 1.0 / task_scales.inverse_deviation[i];
    check(fmt::format("variance of observation {}", i), network.variance[k], deviation * deviation);
    if (i >= kAngles && i < kAngles + kNumJoints) continue;
    check(fmt::format("mean of observation {}", i), network.mean[k], task_scales.mean[i]);
  }
  check("clip of observations", network.clip, task_scales.clip);
  for (const double scale : spec.action_scale_rad) {
    check("action scale", scale, task.action_scale_rad);
  }
  check("action clip", spec.action_clip, task.action_clip);
}

}  // namespace sandrunner::train
