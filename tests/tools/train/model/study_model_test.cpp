// SPDX-License-Identifier: BSD-3-Clause
// Study models: as files, and as they answer.
#include "tools/train/model/study_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "policy/policy_file.h"
#include "policy/safetensors.h"
#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "tests/support/temporary_folder.h"
#include "tools/train/task/leg_modes.h"

namespace sandrunner::train {
namespace {

constexpr std::array<double, kNumLegs> kModeGain = {0.6, 0.7, 0.9, 1.6};

struct Wiring {
  const char* name;
  const char* encoder;
  const char* actor;
};

/// The file of a training with random weights, which it returns in `trained`.
StudyModelFile random_file(const Wiring& wiring, std::vector<float>* trained = nullptr) {
  StudyModelFile file;
  file.spec.name = "random";
  for (int j = 0; j < kNumJoints; ++j) file.spec.joint_names[j] = "joint" + std::to_string(j);
  file.spec.action_scale_rad = 0.3;
  file.spec.kp_nmprad = 50.0;
  file.spec.kd_nmsprad = 0.5;
  file.spec.torque_limit_nm = 60.0;
  file.spec.yaw_command_clip_mps2 = 3.0;
  file.spec.estimate_variance.fill(1.0f);
  file.spec.provenance = {{"config", std::string("network.encoder = \"") + wiring.encoder +
                                         "\"\nnetwork.actor = \"" + wiring.actor + "\"\n"}};
  file.sizes.encoder = learner::parse_encoder("encoder", wiring.encoder);
  file.sizes.actor_sees = learner::parse_actor_inputs("actor", wiring.actor);
  for (int i = 0; i < kObservationSize; ++i) {
    file.scales.mean.push_back(0.1f * static_cast<float>(i % 3));
    file.scales.variance.push_back(0.5f + 0.1f * static_cast<float>(i % 4));
  }
  file.scales.clip = 6.0f;
  const learner::ParameterLayout layout(file.sizes, 80);
  const std::vector<float> parameters = learner::initial_parameters(layout, 5, 0.5);
  if (trained != nullptr) *trained = parameters;
  set_trained(parameters, kModeGain, file);
  return file;
}

class StudyModelTest : public testing::TestWithParam<Wiring> {
 protected:
  std::string path() const { return folder_.path("model.safetensors"); }
  const TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Wirings, StudyModelTest,
                         testing::Values(Wiring{"oracle_h", "lstm", "encoding, estimate, terrain"},
                                         Wiring{"tcn", "tcn", "encoding, estimate"},
                                         Wiring{"oracle_o", "lstm",
                                                "estimate, proprioception, terrain"},
                                         Wiring{"teacher", "insight", "encoding, proprioception"},
                                         Wiring{"student", "lstm", "encoding, proprioception"}),
                         [](const auto& param) { return std::string(param.param.name); });

TEST_P(StudyModelTest, FileHoldsWeightsAndWiring) {
  const StudyModelFile file = random_file(GetParam());
  write_study_model(path(), file);
  EXPECT_TRUE(is_study_model(path()));
  const StudyModelFile read = read_study_model(path());
  EXPECT_EQ(read.parameters, file.parameters);
  EXPECT_EQ(learner::wiring_text(read.sizes.encoder, read.sizes.actor_sees),
            learner::wiring_text(file.sizes.encoder, file.sizes.actor_sees));
  EXPECT_EQ(read.scales.mean, file.scales.mean);
}

TEST_P(StudyModelTest, ChangedWeightFailsTheGoldenRun) {
  write_study_model(path(), random_file(GetParam()));
  TensorFile content = read_safetensors(path());
  for (float& weight : content.tensors.at("actor.1.weight").values) weight *= 1.01f;
  write_safetensors(path(), content);
  try {
    read_study_model(path());
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("golden example fails at step 0: action["),
              std::string::npos)
        << error.what();
  }
}

TEST_P(StudyModelTest, AnswersInJointsWhatTheTrainingAnswersInModes) {
  std::vector<float> trained;
  const StudyModelFile file = random_file(GetParam(), &trained);
  const learner::ParameterLayout layout(file.sizes, 80);
  learner::Weights<float> weights(layout);
  weights.set(trained.data());
  learner::BlockPass<float> pass(layout, 1, 1, 1);
  learner::Matrix<float> memory = learner::Matrix<float>::Zero(layout.memory(), 1);
  learner::Matrix<float> normalised(kObservationSize, 1), modes(kNumJoints, 1);
  std::array<float, learner::kInsightSize> insight{};
  std::array<float, kObservationSize> raw{};
  StudyModel model(file);
  const std::uint8_t go_on = 0;
  double moved = 0.0;
  for (int step = 0; step < 3; ++step) {
    for (int i = 0; i < kObservationSize; ++i) {
      raw[i] = std::sin(static_cast<float>(7 * step + i));
      normalised(i, 0) =
          (raw[i] - file.scales.mean[i]) / std::sqrt(file.scales.variance[i] + 1e-8f);
    }
    for (std::size_t i = 0; i < insight.size(); ++i) insight[i] = raw[i];
    const learner::Matrix<float> seen =
        Eigen::Map<const learner::Matrix<float>>(insight.data(), learner::kInsightSize, 1);
    pass.answer(weights, normalised, seen, &go_on, memory, modes);
    std::array<float, kNumJoints> joints{};
    joints_from_modes(kModeGain, modes.data(), 1, joints.data());
    const PolicyStep answer = model.step(raw, insight);
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_NEAR(answer.target_rad[j], file.spec.action_scale_rad * joints[j], 1e-5);
      moved += std::abs(answer.target_rad[j]);
    }
  }
  EXPECT_GT(moved, 0.1);  // answers of zero would be alike too
}

TEST_P(StudyModelTest, TaskNetworkHasTheWeightsOfTheTraining) {
  std::vector<float> trained;
  write_study_model(path(), random_file(GetParam(), &trained));
  const TaskNetwork network = read_task_network(path(), kModeGain);
  const learner::LayerView& last = network.layout.actor().back();
  for (std::ptrdiff_t i = 0; i < last.bias + kNumJoints; ++i) {
    ASSERT_NEAR(network.parameters[i], trained[i], 1e-6f) << "parameter " << i;
  }
}

TEST_P(StudyModelTest, SetStateRepeatsAStep) {
  StudyModel model(random_file(GetParam()));
  std::array<float, kObservationSize> observation{};
  observation.fill(0.3f);
  const StudyModel::State start = model.state();
  const PolicyStep first = model.step(observation);
  model.step(observation);
  model.set_state(start);
  EXPECT_EQ(model.step(observation).target_rad, first.target_rad);
}

TEST(TaskNetworkTest, PolicyFileRunsOnATaskToo) {
  const TemporaryFolder folder;
  const std::string path = folder.path("policy.safetensors");
  write_file(path, shipped_policy_text());
  const TaskNetwork network = read_task_network(path, kModeGain);
  EXPECT_TRUE(network.layout.sizes().are_a_robots());
  EXPECT_EQ(network.spec.name, "raibo");
}

TEST(StudyModelFileTest, WithoutSettingsItsWiringIsUnknown) {
  const TemporaryFolder folder;
  StudyModelFile file = random_file({"", "lstm", "encoding, proprioception"});
  file.spec.provenance.clear();
  try {
    write_study_model(folder.path("a"), file);
    FAIL() << "was written";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'provenance.config' is missing"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace sandrunner::train
