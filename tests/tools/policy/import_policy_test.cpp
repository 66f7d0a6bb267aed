// SPDX-License-Identifier: BSD-3-Clause
// The script import_policy.py, as a user runs it on weights saved by numpy.
#include <gtest/gtest.h>

#include "policy/policy_file.h"
#include "tests/policy/random_policy.h"
#include "tests/support/program_test.h"

namespace sandrunner {
namespace {

// Saves the network of a policy file as PyTorch users do, the LSTM under PyTorch's names.
constexpr char kSave[] = R"(
import json, struct, sys
import numpy as np
data = open('policy.safetensors', 'rb').read()
size = struct.unpack('<Q', data[:8])[0]
header = json.loads(data[8:8 + size])
arrays = {}
for name, entry in header.items():
    if name == '__metadata__' or name.startswith('golden.'): continue
    begin, end = entry['data_offsets']
    values = np.frombuffer(data[8 + size + begin:8 + size + end], '<f4').reshape(entry['shape'])
    if name.startswith('encoder.'): name = name.replace('encoder.', 'lstm.') + '_l0'
    arrays[name] = values.astype(np.float64)
for change in sys.argv[1:]: exec(change)
np.savez('policy.npz', **arrays)
)";

class ImportPolicyTest : public ProgramTest {
 protected:
  /// With Debian's Python, the one that python3-numpy belongs to.
  ImportPolicyTest() : ProgramTest("/usr/bin/python3") {}

  void SetUp() override {
    write_policy_file(folder_.path("policy.safetensors"), random_policy_file());
    write_file(folder_.path("save.py"), kSave);
    std::string names;
    for (const char* part : {"weight_ih", "weight_hh", "bias_ih", "bias_hh"}) {
      names += std::string("encoder.") + part + " lstm." + part + "_l0\n";
    }
    write_file(folder_.path("names.txt"), names);
  }

  void save(const std::string& change = "") { ASSERT_EQ(run("save.py " + change), 0) << error(); }
  static std::string convert(const std::string& options) {
    return "'" SANDRUNNER_IMPORT_POLICY "' policy.npz --program '" SANDRUNNER_POLICY_PROGRAM
           "' --out new.safetensors " +
           options;
  }
  void expect_refused(const std::string& options, const std::string& cause) {
    ProgramTest::expect_refused(convert(options), cause);
    EXPECT_FALSE(std::filesystem::exists(folder_.path("new.safetensors"))) << options;
  }
};

TEST_F(ImportPolicyTest, WritesAPolicyFileThatPassesItsGoldenExample) {
  save();
  ASSERT_EQ(run(convert("--map names.txt --name mine --set kp_nmprad=40 --set observation_clip=3")),
            0)
      << error();
  PolicyFile before = read_policy_file(folder_.path("policy.safetensors"));
  PolicyFile after = read_policy_file(folder_.path("new.safetensors"));  // runs the example
  EXPECT_EQ(after.spec.name, "mine");
  EXPECT_EQ(after.spec.kp_nmprad, 40.0);
  EXPECT_EQ(after.parameters.observation_clip, 3.0f);
  const auto expected = tensors_of(before.parameters);
  const auto found = tensors_of(after.parameters);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(*found[i].values, *expected[i].values) << found[i].name;
  }
}

TEST_F(ImportPolicyTest, KnowsPyTorchsNamesAndFormatsOfFiles) {
  save("\"arrays = {k.replace('lstm.', 'encoder.'): v for k, v in arrays.items()}\"");
  ASSERT_EQ(run(convert("")), 0) << error();
  const std::string bare = std::string("'" SANDRUNNER_GOLDEN_DIR) + "/random_network.safetensors'";
  ASSERT_EQ(run("'" SANDRUNNER_IMPORT_POLICY "' " + bare +
                " --program '" SANDRUNNER_POLICY_PROGRAM "' --out golden.safetensors"),
            0)
      << error();
  EXPECT_EQ(read_policy_file(folder_.path("golden.safetensors")).spec.name, "random_network");
}

TEST_F(ImportPolicyTest, BadWeightsAreOneLineAndNoFile) {
  const std::pair<const char*, const char*> cases[] = {
      {"del arrays['actor.1.bias']", "tensor 'actor.1.bias' is missing"},
      {"arrays['actor.1.bias'] = np.zeros(7)", "shape [7], expected [128]"},
      {"arrays['actor.1.bias'] = np.full(128, np.nan)", "is not finite"},
      {"arrays['actor.1.bias'] = np.full(128, 'a')", "'actor.1.bias' is not of numbers"},
      {"arrays['estimate.variance'] = np.full(8, -1.0)", "expected at least 0"},
  };
  for (const auto& [change, cause] : cases) {
    save(std::string("\"") + change + "\"");
    expect_refused("--map names.txt", cause);
  }
}

TEST_F(ImportPolicyTest, BadOptionsAndFilesAreOneLineAndNoFile) {
  save();
  for (const char* bad : {"kp_nmprad=4O", "kd_nmsprad=-1", "action_scale_rad=0",
                          "torque_limit_nm=", "observation_clip=nan", "action_clip=1_0"}) {
    expect_refused(std::string("--map names.txt --set ") + bad, bad);
  }
  write_file(folder_.path("latin"), "actor.1.bias \xe9\n");
  expect_refused("--map latin", "latin: found no text file");
  const std::string whole = read_file(folder_.path("policy.npz"));
  write_file(folder_.path("policy.npz"), whole.substr(0, whole.size() / 2));
  expect_refused("--map names.txt", "policy.npz: found no npz of arrays");
}

TEST_F(ImportPolicyTest, WithoutNumpyOneLineSaysWhatToInstall) {
  // -S: Python without the folders that packages are installed to.
  ProgramTest::expect_refused("-S " + convert(""), "import_policy.py: needs numpy");
}

}  // namespace
}  // namespace sandrunner
