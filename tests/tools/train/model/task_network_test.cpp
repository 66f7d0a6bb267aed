// SPDX-License-Identifier: BSD-3-Clause
// Networks of all wirings: as they answer, and as a Task runs them.
#include "tools/train/model/task_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/train/learner/block_pass.h"
#include "tools/train/task/leg_modes.h"

namespace sandrunner::train {
namespace {

constexpr std::array<double, kNumLegs> kModeGain = {0.6, 0.7, 0.9, 1.6};

/// The file of a training with random weights, which it returns in `trained`.
PolicyFile random_file(const Wiring& wiring, std::vector<float>* trained = nullptr) {
  PolicyFile file = parse_policy_file(shipped_policy_text(), "the shipped policy");
  file.spec.nominal_position_rad = {};
  learner::NetworkSizes sizes;
  sizes.wiring = wiring;
  const learner::ParameterLayout layout(sizes, 80);
  std::vector<float> parameters = learner::initial_parameters(layout, 5, 0.5);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    parameters[i] += 0.01f * std::sin(static_cast<float>(i));  // no bias is 0
  }
  if (trained != nullptr) *trained = parameters;
  learner::to_policy(layout, parameters, file.parameters);
  answer_in_joints(kModeGain, file.parameters);
  file.golden = make_golden_example(file.parameters);
  return file;
}

class TaskNetworkTest : public testing::TestWithParam<Wiring> {};

constexpr ActorInputs kUsual, kProprioception = {true, false, true, false};
INSTANTIATE_TEST_SUITE_P(Wirings, TaskNetworkTest,
                         testing::Values(Wiring{EncoderKind::kLstm, {true, true, false, true}},
                                         Wiring{EncoderKind::kTcn, kUsual},
                                         Wiring{EncoderKind::kLstm, {false, true, true, true}},
                                         Wiring{EncoderKind::kInsight, kProprioception},
                                         Wiring{EncoderKind::kLstm, kProprioception}, Wiring{}),
                         [](const auto& test) { return "Wiring" + std::to_string(test.index); });

TEST_P(TaskNetworkTest, APolicyAnswersInJointsWhatTheTrainingAnswersInModes) {
  if (GetParam().sees_insight()) return;  // is no policy
  std::vector<float> trained;
  const PolicyFile file = random_file(GetParam(), &trained);
  const NetworkParameters& p = file.parameters;
  learner::NetworkSizes sizes;
  sizes.wiring = GetParam();
  const learner::ParameterLayout layout(sizes, 80);
  learner::Weights<float> weights(layout);
  weights.set(trained.data());
  learner::BlockPass<float> pass(layout, 1, 1, 1);
  learner::Matrix<float> memory = learner::Matrix<float>::Zero(layout.memory(), 1);
  learner::Matrix<float> normalised(kObservationSize, 1), modes(kNumJoints, 1);
  const learner::Matrix<float> insight = learner::Matrix<float>::Zero(kInsightSize, 1);
  std::array<float, kObservationSize> raw{};
  Policy policy(file.spec, Network(p));
  double moved = 0.0;
  for (int step = 0; step < 70; ++step) {
    const std::uint8_t reset = step == 10;
    if (reset != 0) policy.reset();
    for (int i = 0; i < kObservationSize; ++i) {
      raw[i] = std::sin(static_cast<float>(7 * step + i));
      normalised(i, 0) =
          (raw[i] - p.observation_mean[i]) / std::sqrt(p.observation_variance[i] + 1e-8f);
      normalised(i, 0) = std::clamp(normalised(i, 0), -p.observation_clip, p.observation_clip);
    }
    pass.answer(weights, normalised, insight, &reset, memory, modes);
    std::array<float, kNumJoints> joints{};
    joints_from_modes(kModeGain, modes.data(), 1, joints.data());
    const PolicyStep answer = policy.step(raw);
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_NEAR(answer.target_rad[j], file.spec.action_scale_rad[j] * joints[j], 2e-6);
      moved += std::abs(answer.target_rad[j]);
    }
  }
  EXPECT_GT(moved, 0.1);  // answers of zero would be alike too
}

TEST_P(TaskNetworkTest, TaskNetworkHasTheWeightsOfTheTraining) {
  std::vector<float> trained;
  const TaskNetwork network = make_task_network(random_file(GetParam(), &trained), kModeGain);
  const learner::LayerView& last = network.layout.actor().back();
  for (std::ptrdiff_t i = 0; i < last.bias + kNumJoints; ++i) {
    ASSERT_NEAR(network.parameters[i], trained[i], 1e-6f) << "parameter " << i;
  }
}

TEST(ShippedPolicyTest, RunsOnATaskToo) {
  const TaskNetwork network =
      make_task_network(parse_policy_file(shipped_policy_text(), "the shipped policy"), kModeGain);
  EXPECT_TRUE(network.layout.sizes().wiring == Wiring{});
  EXPECT_EQ(network.spec.name, "raibo");
}

}  // namespace
}  // namespace sandrunner::train
