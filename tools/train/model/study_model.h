// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "policy/policy_file.h"
#include "tools/train/learner/block_pass.h"
#include "tools/train/model/task_network.h"

namespace sandrunner::train {

/// The networks of a file for one robot, step by step.
template <typename Scalar>
class ModelNetwork {
 public:
  explicit ModelNetwork(const NetworkParameters& file)
      : layout_(model_layout(file.wiring)),
        weights_(layout_),
        pass_(layout_, 1, 1, 1),
        mean_(file.observation_mean.begin(), file.observation_mean.end()),
        clip_(static_cast<Scalar>(file.observation_clip)),
        observation_(kObservationSize, 1),
        insight_(kInsightSize, 1),
        action_(kNumJoints, 1),
        memory_(learner::Matrix<Scalar>::Zero(layout_.memory(), 1)) {
    std::vector<float> parameters(static_cast<std::size_t>(layout_.size()));
    learner::from_policy(file, layout_, parameters);
    weights_.set(std::vector<Scalar>(parameters.begin(), parameters.end()).data());
    for (const float variance : file.observation_variance) {
      inverse_deviation_.push_back(1 / std::sqrt(static_cast<Scalar>(variance) + Scalar(1e-8)));
    }
  }

  /// observation: raw, 33 numbers; insight: 22, which count only if a network sees them.
  void step(const float* observation, const float* insight) {
    constexpr std::uint8_t kGoOn = 0;
    for (int i = 0; i < kObservationSize; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Scalar x = (static_cast<Scalar>(observation[i]) - mean_[k]) * inverse_deviation_[k];
      observation_(i, 0) = std::clamp(x, -clip_, clip_);
    }
    for (int i = 0; i < kInsightSize; ++i) {
      insight_(i, 0) = static_cast<Scalar>(insight[i]);
    }
    pass_.answer(weights_, observation_, insight_, &kGoOn, memory_, action_);
  }
  Scalar action(int joint) const { return action_(joint, 0); }
  Scalar estimate(int i) const { return pass_.estimate()(i, 0); }
  const learner::Matrix<Scalar>& encoding() const { return pass_.encoding(); }

  /// Zero before the first step.
  learner::Matrix<Scalar>& memory() { return memory_; }

 private:
  learner::ParameterLayout layout_;
  learner::Weights<Scalar> weights_;
  learner::BlockPass<Scalar> pass_;
  std::vector<Scalar> mean_, inverse_deviation_;
  Scalar clip_;
  learner::Matrix<Scalar> observation_, insight_, action_, memory_;
};

/// Networks of any wiring that run, with the functions of Policy. Not for real time.
class StudyModel {
 public:
  using State = std::vector<float>;

  explicit StudyModel(PolicyFile file) : network_(file.parameters), spec_(std::move(file.spec)) {}

  void reset() { network_.memory().setZero(); }

  /// One step at kPolicyHz. `observation` is raw; `insight` as Task makes it, for a model that sees
  /// it.
  PolicyStep step(const std::array<float, kObservationSize>& observation,
                  const std::array<float, kInsightSize>& insight = {}) {
    network_.step(observation.data(), insight.data());
    std::array<float, kNumJoints> action{};
    std::array<float, kEstimateSize> estimate{};
    for (int i = 0; i < kNumJoints; ++i) action[i] = network_.action(i);
    for (int i = 0; i < kEstimateSize; ++i) estimate[i] = network_.estimate(i);
    return policy_step(spec_, action, estimate);
  }

  State state() {
    const auto& memory = network_.memory();
    return {memory.data(), memory.data() + memory.size()};
  }
  void set_state(const State& state) { std::ranges::copy(state, network_.memory().data()); }

  const PolicySpec& spec() const { return spec_; }

 private:
  ModelNetwork<float> network_;
  PolicySpec spec_;
};

}  // namespace sandrunner::train
