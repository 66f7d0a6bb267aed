// SPDX-License-Identifier: BSD-3-Clause
#include "policy/policy_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "policy/safetensors.h"
#include "rt/base/errors.h"
#include "tests/policy/random_policy.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

/// Expects that loading `path` fails in one line that names the file and contains `cause`.
void expect_refused(const std::string& path, const std::string& cause) {
  const std::string message = error_of([&] { load_policy(path); });
  EXPECT_NE(message.find("'" + path + "': "), std::string::npos) << message;
  EXPECT_NE(message.find(cause), std::string::npos) << message << "\nexpected: " << cause;
}

class PolicyFileTest : public testing::Test {
 protected:
  PolicyFileTest() { write_policy_file(path_, file_); }

  /// Changes the file as a container, past the checks of write_policy_file, and expects that it is
  /// refused.
  void expect_refused_after(const std::function<void(TensorFile&)>& change,
                            const std::string& cause) {
    TensorFile content = read_safetensors(path_);
    change(content);
    write_safetensors(folder_.path("changed"), content);
    expect_refused(folder_.path("changed"), cause);
  }

  void expect_refused_with(const std::string& key, const std::string& value,
                           const std::string& cause) {
    expect_refused_after([&](TensorFile& f) { f.metadata[key] = value; }, cause);
  }

  const PolicyFile file_ = random_policy_file();
  const TemporaryFolder folder_;
  const std::string path_ = folder_.path("policy.safetensors");
};

TEST_F(PolicyFileTest, ReadsBackWhatItWrote) {
  const PolicyFile again = read_policy_file(path_);
  EXPECT_EQ(again.spec.name, file_.spec.name);
  EXPECT_EQ(again.spec.nominal_position_rad, file_.spec.nominal_position_rad);
  EXPECT_EQ(again.spec.action_scale_rad, file_.spec.action_scale_rad);
  EXPECT_EQ(again.spec.action_clip, file_.spec.action_clip);
  EXPECT_EQ(again.spec.kp_nmprad, file_.spec.kp_nmprad);
  EXPECT_EQ(again.spec.kd_nmsprad, file_.spec.kd_nmsprad);
  EXPECT_EQ(again.spec.torque_limit_nm, file_.spec.torque_limit_nm);
  EXPECT_EQ(again.spec.yaw_command_clip_mps2, file_.spec.yaw_command_clip_mps2);
  EXPECT_EQ(again.spec.estimate_mean, file_.spec.estimate_mean);
  EXPECT_EQ(again.spec.estimate_variance, file_.spec.estimate_variance);
  EXPECT_EQ(again.spec.provenance, file_.spec.provenance);
  EXPECT_EQ(again.parameters.observation_clip, file_.parameters.observation_clip);
  EXPECT_EQ(again.golden.action, file_.golden.action);
}

const Wiring kTcn = {EncoderKind::kTcn, {}};
const Wiring kTeacher = {EncoderKind::kInsight, {true, false, true, false}};
const Wiring kOracle = {EncoderKind::kLstm, {false, true, true, true}};

class WiringTest : public PolicyFileTest, public testing::WithParamInterface<Wiring> {};

INSTANTIATE_TEST_SUITE_P(Wirings, WiringTest, testing::Values(Wiring{}, kTcn, kTeacher, kOracle),
                         [](const auto& test) { return "Wiring" + std::to_string(test.index); });

TEST_P(WiringTest, IsReadBackWithAllTensors) {
  PolicyFile file = random_policy_file(3, GetParam());
  write_policy_file(path_, file);
  PolicyFile again = read_policy_file(path_);
  EXPECT_EQ(wiring_text(again.parameters.wiring), wiring_text(GetParam()));
  const auto expected = tensors_of(file.parameters);
  const auto found = tensors_of(again.parameters);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(*found[i].values, *expected[i].values) << expected[i].name;
  }
}

TEST_P(WiringTest, ChangedWeightFailsTheGoldenExample) {
  write_policy_file(path_, random_policy_file(3, GetParam()));
  expect_refused_after(
      [](TensorFile& f) {
        for (float& weight : f.tensors.at("actor.1.weight").values) weight *= 1.01f;
      },
      "golden example fails at step 0: action[");
}

TEST_F(PolicyFileTest, NamesItsWiringOnlyIfThatIsNotTheUsualOne) {
  EXPECT_FALSE(read_safetensors(path_).metadata.contains("sandrunner.encoder"));
  write_policy_file(path_, random_policy_file(1, kOracle));
  const auto metadata = read_safetensors(path_).metadata;
  EXPECT_EQ(metadata.at("sandrunner.encoder"), "lstm");
  EXPECT_EQ(metadata.at("sandrunner.actor"), "estimate, proprioception, terrain");
}

TEST_F(PolicyFileTest, RefusesAnUnknownWiring) {
  expect_refused_with("sandrunner.encoder", "gru",
                      "metadata 'sandrunner.encoder': found 'gru', expected one of lstm, tcn");
  expect_refused_with("sandrunner.actor", "smell",
                      "metadata 'sandrunner.actor': found 'smell', expected some of encoding");
  expect_refused_with("sandrunner.encoder", "tcn", "tensor 'encoder.0.weight' is missing");
}

TEST_F(PolicyFileTest, OfANetworkThatNeedsWhatNoRobotCanSenseMakesNoPolicy) {
  for (const Wiring& wiring : {kTeacher, kOracle}) {
    write_policy_file(path_, random_policy_file(1, wiring));
    expect_refused(path_, "needs what no robot can sense (" + wiring_text(wiring) + ")");
  }
}

TEST_F(PolicyFileTest, LoadedPolicyStepsAsTheOneThatWasWritten) {
  Policy loaded = load_policy(path_);
  Policy original(file_.spec, Network(file_.parameters));
  RandomFloats random(2);
  for (int k = 0; k < 5; ++k) {
    const auto observation = random.observation();
    EXPECT_EQ(loaded.step(observation).target_rad, original.step(observation).target_rad);
  }
}

TEST_F(PolicyFileTest, RefusesTruncationAtEveryThousandthByte) {
  const std::string bytes = read_file(path_);
  const std::string cut = folder_.path("cut");
  write_file(cut, bytes);
  for (std::size_t size = (bytes.size() - 1) / 1000 * 1000; size > 0; size -= 1000) {
    std::filesystem::resize_file(cut, size);
    expect_refused(cut, "");
  }
  write_file(cut, bytes.substr(0, bytes.size() - 1));
  expect_refused(cut, "");
  std::filesystem::resize_file(cut, 0);
  expect_refused(cut, "0 bytes are too few");
}

TEST_F(PolicyFileTest, RefusesRandomBytes) {
  RandomFloats random(4);
  for (const std::size_t size : {7, 8, 100, 1000, 419600}) {
    std::string bytes;
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(random.bits());
    write_file(folder_.path("random"), bytes);
    expect_refused(folder_.path("random"), "");
  }
}

TEST_F(PolicyFileTest, DamagedHeaderIsRefusedOrHarmless) {
  const std::string bytes = read_file(path_);
  RandomFloats random(6);
  int refused = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::string damaged = bytes;
    damaged[random.bits() % 2500] = static_cast<char>(random.bits());
    write_file(folder_.path("damaged"), damaged);
    try {
      load_policy(folder_.path("damaged"));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 150);  // a letter of the name or of the provenance may change unseen
}

TEST_F(PolicyFileTest, RefusesOtherSizesAndNamesThem) {
  expect_refused_after(
      [](TensorFile& f) {
        f.tensors["encoder.weight_hh"] = {{512, 128}, std::vector<float>(512 * 128)};
      },
      "tensor 'encoder.weight_hh' has shape [512, 128], expected [256, 64]");
  expect_refused_after([](TensorFile& f) { f.tensors["actor.0.weight"].shape = {75, 256}; },
                       "tensor 'actor.0.weight' has shape [75, 256], expected [256, 75]");
  expect_refused_after(
      [](TensorFile& f) {
        f.tensors["golden.action"] = {{49, kNumJoints}, std::vector<float>(49 * kNumJoints)};
      },
      "tensor 'golden.action' has shape [49, 12], expected [50, 12]");
}

TEST_F(PolicyFileTest, RefusesMissingAndUnknownTensors) {
  expect_refused_after([](TensorFile& f) { f.tensors.erase("estimator.1.bias"); },
                       "tensor 'estimator.1.bias' is missing");
  expect_refused_after([](TensorFile& f) { f.tensors["critic.0.bias"] = {{1}, {0.0f}}; },
                       "unknown tensor 'critic.0.bias'");
}

TEST_F(PolicyFileTest, RefusesNaN) {
  std::string bytes = read_file(path_);
  const std::size_t half = bytes.size() / 2;
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(half), bytes.end(), '\xff');
  write_file(folder_.path("nan"), bytes);
  expect_refused(folder_.path("nan"), "is not finite");
}

TEST_F(PolicyFileTest, RefusesNegativeVariance) {
  expect_refused_after([](TensorFile& f) { f.tensors["observation.variance"].values[3] = -1.0f; },
                       "tensor 'observation.variance': value 3 is -1, expected at least 0");
}

TEST_F(PolicyFileTest, RefusesAFailingGoldenExample) {
  expect_refused_after(
      [](TensorFile& f) { f.tensors["golden.action"].values[12 * 7 + 3] += 0.01f; },
      "golden example fails at step 7: action[3] is ");
  expect_refused_after([](TensorFile& f) { f.tensors["encoder.weight_hh"].values[100] += 0.1f; },
                       "golden example fails at step ");
  expect_refused_after([](TensorFile& f) { f.tensors["golden.estimate"].values[8] += 0.01f; },
                       "golden example fails at step 1: estimate[0] is ");
}

TEST_F(PolicyFileTest, KeepsTheJointNamesOfAnyRobot) {
  PolicyFile other = file_;
  for (std::string& name : other.spec.joint_names) name += "_motor";
  write_policy_file(path_, other);
  EXPECT_EQ(read_policy_file(path_).spec.joint_names, other.spec.joint_names);
}

TEST_F(PolicyFileTest, RefusesJointsThatCannotBeToldApart) {
  expect_refused_with("sandrunner.joint_names", "a,b,c", "has 3 values, expected 12");
  expect_refused_with("sandrunner.joint_names", "a,b,c,d,e,f,g,h,i,j,k,",
                      "has the joint name '', expected 12 different names");
  expect_refused_with("sandrunner.joint_names", "a,b,c,d,e,f,g,h,i,j,k,b",
                      "has the joint name 'b', expected 12 different names");
}

TEST_F(PolicyFileTest, RefusesOtherRates) {
  expect_refused_with("sandrunner.policy_hz", "50", "is '50', expected '100'");
  expect_refused_with("sandrunner.control_hz", "1000", "is '1000', expected '4000'");
}

TEST_F(PolicyFileTest, RefusesBadMetadata) {
  expect_refused_with("sandrunner.format", "2", "is '2', expected '1'");
  expect_refused_with("sandrunner.kp_nmprad", "-1", "is -1, expected at least 0");
  expect_refused_with("sandrunner.kd_nmsprad", "nan", "is 'nan', expected a number");
  expect_refused_with("sandrunner.torque_limit_nm", "63.45 N", "is '63.45 N', expected a number");
  expect_refused_with("sandrunner.action_scale_rad", "0", "is 0, expected more than 0");
  expect_refused_with("sandrunner.observation_clip", "1e999", "is '1e999', expected a number");
  expect_refused_with("sandrunner.nominal_position_rad", "0,0.5,-1", "has 3 values, expected 12");
  expect_refused_with("sandrunner.nominal_position_rad", "0,0.5,,0,0,0,0,0,0,0,0,0",
                      "is '', expected a number");
  expect_refused_with("sandrunner.kp", "50", "unknown metadata key 'sandrunner.kp'");
  expect_refused_after([](TensorFile& f) { f.metadata.erase("sandrunner.kp_nmprad"); },
                       "metadata key 'sandrunner.kp_nmprad' is missing");
  expect_refused_after([](TensorFile& f) { f.metadata.clear(); }, "not a policy file");
}

TEST_F(PolicyFileTest, RefusesANumberThatNoDoubleHolds) {
  std::string bytes = read_file(path_);
  const std::size_t at = bytes.find("\"shape\":[") + 9;
  bytes.replace(at, 5, "1e999");  // whatever stood there: it ends the reading
  write_file(folder_.path("huge"), bytes);
  expect_refused(folder_.path("huge"), "not valid JSON");
}

TEST_F(PolicyFileTest, ActionClipMayBeAbsent) {
  TensorFile content = read_safetensors(path_);
  content.metadata.erase("sandrunner.action_clip");
  write_safetensors(path_, content);
  EXPECT_EQ(read_policy_file(path_).spec.action_clip, 0.0);
}

TEST_F(PolicyFileTest, DoesNotWriteWhatItWouldRefuse) {
  const std::string before = read_file(path_);
  PolicyFile bad = file_;
  bad.spec.kp_nmprad = -1.0;
  EXPECT_THROW(write_policy_file(path_, bad), InputError);
  bad = file_;
  bad.golden.action[5] += 0.01f;
  EXPECT_THROW(write_policy_file(path_, bad), InputError);
  bad = file_;
  bad.parameters.encoder_bias_ih.pop_back();
  EXPECT_THROW(write_policy_file(path_, bad), InputError);
  EXPECT_EQ(read_file(path_), before);
  EXPECT_EQ(folder_.number_of_files(), 1u);
}

}  // namespace
}  // namespace sandrunner
