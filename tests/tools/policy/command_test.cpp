// SPDX-License-Identifier: BSD-3-Clause
// The program sandrunner-policy, as a user runs it.
#include <gtest/gtest.h>

#include "policy/policy_file.h"
#include "policy/safetensors.h"
#include "tests/policy/random_policy.h"
#include "tests/support/program_test.h"

namespace sandrunner {
namespace {

class PolicyCommandTest : public ProgramTest {
 protected:
  PolicyCommandTest() : ProgramTest(SANDRUNNER_POLICY_PROGRAM) {}

  /// Weights as others publish them.
  void write_bare_weights(const std::string& name) {
    const std::string path = folder_.path(name);
    write_policy_file(path, random_policy_file());
    TensorFile content = read_safetensors(path);
    content.metadata = {{"license", "MIT"}};
    std::erase_if(content.tensors, [](const auto& t) { return t.first.starts_with("golden."); });
    write_safetensors(path, content);
  }
};

TEST_F(PolicyCommandTest, ImportsBareWeightsWithTheConventionsOfRaibo) {
  write_bare_weights("weights.safetensors");
  ASSERT_EQ(run("import weights.safetensors --out policy.safetensors"), 0);
  const PolicyFile file = read_policy_file(folder_.path("policy.safetensors"));
  EXPECT_EQ(file.spec.name, "weights");
  EXPECT_EQ(file.spec.nominal_position_rad[10], 0.559836);
  EXPECT_EQ(file.spec.nominal_position_rad[11], -1.119672);
  EXPECT_EQ(file.spec.action_scale_rad[0], 0.3);
  EXPECT_EQ(file.spec.kp_nmprad, 50.0);
  EXPECT_EQ(file.spec.kd_nmsprad, 0.5);
  EXPECT_EQ(file.spec.torque_limit_nm, 63.45);
  EXPECT_EQ(file.parameters.observation_clip, 10.0f);
  EXPECT_EQ(file.spec.provenance.at("license"), "MIT");
  EXPECT_EQ(file.spec.provenance.at("imported_from"), "weights.safetensors");
  EXPECT_EQ(file.parameters.encoder_weight_hh, random_policy_file().parameters.encoder_weight_hh);
}

TEST_F(PolicyCommandTest, ImportTakesPoseAndLimitsFromTheRobotAndTheRestFromSettings) {
  write_bare_weights("weights.safetensors");
  ASSERT_EQ(run("import weights.safetensors --out policy.safetensors --robot go2 --name mine "
                "--set kp_nmprad=20 --set action_clip=5"),
            0)
      << error();
  const PolicyFile file = read_policy_file(folder_.path("policy.safetensors"));
  const PolicySpec shipped = load_shipped_policy("go2").spec();
  EXPECT_EQ(file.spec.joint_names, shipped.joint_names);
  EXPECT_EQ(file.spec.nominal_position_rad, shipped.nominal_position_rad);
  EXPECT_EQ(file.spec.torque_limit_nm, shipped.torque_limit_nm);
  EXPECT_EQ(file.spec.kp_nmprad, 20.0);
  EXPECT_EQ(file.spec.action_clip, 5.0);
  EXPECT_EQ(file.spec.kd_nmsprad, 0.5);
  EXPECT_EQ(file.spec.provenance.at("license"), "MIT");
}

TEST_F(PolicyCommandTest, ImportsWeightsThatOtherCodeWrote) {
  const std::string weights = SANDRUNNER_GOLDEN_DIR "/random_network.safetensors";
  ASSERT_EQ(run("import '" + weights + "' --out policy.safetensors --name golden"), 0) << error();
  ASSERT_EQ(run("info policy.safetensors"), 0);
  EXPECT_NE(output().find("golden"), std::string::npos) << output();
  EXPECT_NE(output().find("104340 parameters"), std::string::npos) << output();
  EXPECT_NE(output().find("50 steps pass"), std::string::npos) << output();
}

TEST_F(PolicyCommandTest, InfoShowsWhatTheFileHolds) {
  write_policy_file(folder_.path("policy"), random_policy_file());
  ASSERT_EQ(run("info policy"), 0);
  for (const char* text : {"random", "LSTM 30-64", "64-128-128-8", "75-256-128-12", "Kp 40 N m/rad",
                           "Kd 0.75", "+-3", "50 steps pass"}) {
    EXPECT_NE(output().find(text), std::string::npos) << text << " not in\n" << output();
  }
}

TEST_F(PolicyCommandTest, EnvelopeIsWrittenAndTurnsAtSpeedAreNarrowedWhereAsked) {
  write_policy_file(folder_.path("policy"), random_policy_file());
  const std::string speeds =
      " --forward 3 --backward 1 --lateral 0.5 --yaw 1.5 --acceleration 2 --yaw-acceleration 4";
  ASSERT_EQ(run("envelope policy --out kept" + speeds), 0) << error();
  const PolicySpec kept = read_policy_file(folder_.path("kept")).spec;
  EXPECT_TRUE(kept.has_envelope);
  EXPECT_EQ(kept.envelope.forward_mps, 3.0);
  EXPECT_EQ(kept.envelope.backward_mps, 1.0);
  EXPECT_EQ(kept.envelope.lateral_mps, 0.5);
  EXPECT_EQ(kept.envelope.yaw_radps, 1.5);
  EXPECT_EQ(kept.envelope.acceleration_mps2, 2.0);
  EXPECT_EQ(kept.envelope.yaw_acceleration_radps2, 4.0);
  EXPECT_EQ(kept.yaw_command_clip_mps2, random_policy_file().spec.yaw_command_clip_mps2);
  ASSERT_EQ(run("envelope policy --out narrow --centripetal 1.25" + speeds), 0) << error();
  EXPECT_EQ(read_policy_file(folder_.path("narrow")).spec.yaw_command_clip_mps2, 1.25);
}

TEST_F(PolicyCommandTest, HelpAndVersionSucceed) {
  EXPECT_EQ(run("--help"), 0);
  EXPECT_NE(output().find("import"), std::string::npos);
  EXPECT_EQ(run("import --help"), 0);
  EXPECT_EQ(run("--version"), 0);
  EXPECT_EQ(output().rfind("sandrunner-policy ", 0), 0u);
}

TEST_F(PolicyCommandTest, InfoPrintsSettingsOneInEachLine) {
  PolicyFile file = random_policy_file();
  file.spec.provenance["config"] = "a.first = 1\nb.second = 2\n";
  write_policy_file(folder_.path("policy"), file);
  ASSERT_EQ(run("info policy"), 0);
  EXPECT_NE(output().find("\nconfig\n  a.first = 1\n  b.second = 2\n"), std::string::npos)
      << output();
}

TEST_F(PolicyCommandTest, BadInputIsOneLineAndExitCodeTwo) {
  write_bare_weights("weights");
  write_file(folder_.path("garbage"), "garbage");
  expect_refused("", "found no command, expected import, ");
  expect_refused("convert x", "found 'convert', expected import, ");
  expect_refused("import weights", "--out");
  expect_refused("info", "FILE");
  expect_refused("info weights weights", "unexpected");
  expect_refused("info absent",
                 "absent: cannot be read (No such file or directory), expected a policy file");
  expect_refused("info garbage", "'garbage': 7 bytes are too few");
  expect_refused("info weights", "not a policy file");
  expect_refused("import garbage --out policy", "'garbage': ");
  expect_refused("import weights --out absent/policy",
                 "absent/policy: cannot be written (No such file");
  expect_refused("import weights --out policy --robot absent", "absent");
  expect_refused("import weights --out policy --set kp=50", "--set: found 'kp=50', expected KEY=");
  expect_refused("import weights --out policy --set kp_nmprad", "--set: found 'kp_nmprad'");
  expect_refused("import weights --out policy --set kd_nmsprad=-1", "is -1, expected at least 0");
  expect_refused("import weights --out .", ".: cannot be written (not a regular file)");
  expect_refused("import weights --out policy --name \"$(printf '\\377')\"", "UTF-8");
  EXPECT_FALSE(std::filesystem::exists(folder_.path("policy")));
}

TEST_F(PolicyCommandTest, RefusedImportLeavesTheTargetAsItWas) {
  write_file(folder_.path("garbage"), "garbage");
  write_file(folder_.path("policy"), "precious");
  expect_refused("import garbage --out policy", "'garbage': ");
  EXPECT_EQ(read_file(folder_.path("policy")), "precious");
}

TEST_F(PolicyCommandTest, FileThatMayNotGrowIsRefusedAndNotASignal) {
  write_bare_weights("weights");
  EXPECT_EQ(run_line("ulimit -f 1; " SANDRUNNER_POLICY_PROGRAM " import weights --out policy"), 2);
  EXPECT_NE(error().find("policy: cannot be written"), std::string::npos) << error();
}

}  // namespace
}  // namespace sandrunner
