// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/models.h"

#include <gtest/gtest.h>

#include "policy/policy_file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/study/random_model.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

class ModelsTest : public testing::Test {
 protected:
  void put(const std::string& name) const { write_file(folder_.path(name), shipped_policy_text()); }
  std::vector<std::string> load(const std::vector<int>& seeds = {}) const {
    std::vector<std::string> names;
    for (const Model& m : load_models(folder_.path(""), seeds, robot_)) {
      names.push_back(model_name(m));
    }
    return names;
  }
  std::string refusal() const {
    return error_of([&] { load(); });
  }
  const TemporaryFolder folder_;
  const sim::Robot robot_ = sim::load_raibo();
};

using Names = std::vector<std::string>;

TEST_F(ModelsTest, AreInTheOrderOfTheTablesAndOfTheSeeds) {
  for (const char* name : {"env-rigid-1", "ours-10", "ours-2", "env-linear-1"}) {
    put(std::string(name) + ".safetensors");
  }
  write_file(folder_.path("ours-2.csv"), "transitions\n");
  EXPECT_EQ(load(), (Names{"ours-2", "ours-10", "env-rigid-1", "env-linear-1"}));
  EXPECT_EQ(load({10, 1}), (Names{"ours-10", "env-rigid-1", "env-linear-1"}));
}

TEST_F(ModelsTest, OfControllersThatSeeTheGroundRunInTheTrainingsEnvironmentsAlone) {
  put("ours-1.safetensors");
  write_random_model(folder_.path("tcn-1.safetensors"), "encoding, estimate", "tcn");
  write_random_model(folder_.path("oracle-h-1.safetensors"), "encoding, estimate, terrain");
  for (const Model& model : load_models(folder_.path(""), {}, robot_)) {
    EXPECT_EQ(model.policy.has_value(), model_name(model) != "oracle-h-1") << model_name(model);
  }
}

TEST_F(ModelsTest, RefuseNetworksThatAreWiredAsThoseOfAnotherController) {
  put("oracle-h-1.safetensors");
  EXPECT_EQ(refusal(), folder_.path("oracle-h-1.safetensors") +
                           ": found networks wired as 'encoder lstm, actor sees encoding, "
                           "estimate', expected 'encoder lstm, actor sees encoding, estimate, "
                           "terrain'");
}

TEST_F(ModelsTest, RefuseANetworkThatSeesOtherScales) {
  std::string text(shipped_policy_text());
  const std::string name = "sandrunner.action_scale_rad\":\"";
  const std::size_t at = text.find(name);
  ASSERT_NE(at, std::string::npos);
  text[at + name.size()] = '1';
  write_file(folder_.path("ours-1.safetensors"), text);
  EXPECT_NE(refusal().find("its action scale is 1.3, expected 0.3"), std::string::npos)
      << refusal();
}

TEST_F(ModelsTest, RefuseAFileThatIsNeitherAPolicyNorAStudyModel) {
  write_file(folder_.path("pl-gm-1.safetensors"), "something else");
  EXPECT_NE(refusal().find("pl-gm-1.safetensors"), std::string::npos) << refusal();
}

TEST_F(ModelsTest, RefuseAnUnknownNameAndAnEmptyFolder) {
  EXPECT_NE(refusal().find("found no trained controller"), std::string::npos) << refusal();
  put("env-sand-1.safetensors");
  EXPECT_NE(refusal().find("found the name 'env-sand-1'"), std::string::npos) << refusal();
}

TEST_F(ModelsTest, RefuseASeedThatIsNoNumber) {
  put("ours-one.safetensors");
  EXPECT_NE(refusal().find("found the name 'ours-one'"), std::string::npos) << refusal();
}

TEST(HashTest, ChangesWithAnyByteAndWithTheLength) {
  EXPECT_EQ(hash_of("sand"), hash_of("sand"));
  EXPECT_NE(hash_of("sand"), hash_of("send"));
  EXPECT_NE(hash_of("sand"), hash_of(std::string("sand\0", 5)));
}

TEST(BeachTest, RunZeroIsThePresetAndTheOthersDifferFromItWithinTheirRanges) {
  const sim::GroundParameters preset = beach(0).patches[0].ground;
  EXPECT_EQ(preset.sigma_flat_npm3, 1.0e6);
  for (int run = 1; run < 200; ++run) {
    const sim::GroundParameters g = beach(run).patches[0].ground;
    EXPECT_NEAR(std::log(g.sigma_flat_npm3 / preset.sigma_flat_npm3), 0.0, 0.3);
    EXPECT_NEAR(std::log(g.sigma_cone_npm3 / preset.sigma_cone_npm3), 0.0, 0.3);
    EXPECT_NEAR(g.friction, 0.75, 0.15);
    EXPECT_NEAR(g.mass_scaling / preset.mass_scaling, 1.0, 0.2);
    EXPECT_NE(g.sigma_flat_npm3, beach(run - 1).patches[0].ground.sigma_flat_npm3);
  }
}

TEST(TrainingGroundTest, IsOfTheKindOfTheControllersTraining) {
  const sim::Robot robot = sim::load_raibo();
  const auto ground = [&](const char* key) {
    return training_ground(*find_controller(key), robot).patches[0].ground;
  };
  EXPECT_EQ(ground("ours").kind, sim::GroundKind::kGranular);
  EXPECT_TRUE(ground("ours").inertial_drag);
  EXPECT_EQ(ground("env-rigid").kind, sim::GroundKind::kRigid);
  EXPECT_FALSE(ground("env-quasistatic").inertial_drag || ground("env-quasistatic").added_mass);
  EXPECT_EQ(ground("env-linear").kind, sim::GroundKind::kLinear);
}

}  // namespace
}  // namespace sandrunner::study
