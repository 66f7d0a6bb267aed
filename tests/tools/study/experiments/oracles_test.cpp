// SPDX-License-Identifier: BSD-3-Clause
// E8 on oracles with random weights.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/temporary_folder.h"
#include "tests/tools/study/random_model.h"
#include "tools/study/experiments/experiments.h"

namespace sandrunner::study {
namespace {

Model random_oracle(const std::string& key, const std::string& actor) {
  const TemporaryFolder folder;
  write_random_model(folder.path(key + "-1.safetensors"), actor);
  return load_models(folder.path(""), {}, sim::load_raibo()).at(0);
}

RunGroup measure(const Model& model, int threads = 1) {
  Lab lab({.runs = 1, .threads = threads, .grid_runs = 1});
  const Measured measured = run_attribution(lab, model);
  EXPECT_EQ(measured.groups.size(), 1u);
  return measured.groups.at(0);
}

class OraclesTest : public testing::Test {
 protected:
  const Model with_history_ = random_oracle("oracle-h", "encoding, estimate, terrain");
  const Model without_ = random_oracle("oracle-o", "estimate, proprioception, terrain");
};

TEST_F(OraclesTest, EachPartOfTheActorsInputHasAnAblation) {
  const auto names = [](const RunGroup& group) {
    std::vector<std::string> found;
    for (const auto& [name, values] : group.runs) {
      found.push_back(name);
      EXPECT_GT(values.at(0), 0.0) << name;
    }
    return found;
  };
  EXPECT_EQ(names(measure(with_history_)), (std::vector<std::string>{"T", "cmd", "e", "h"}));
  EXPECT_EQ(names(measure(without_)), (std::vector<std::string>{"T", "cmd", "e", "o"}));
}

TEST_F(OraclesTest, OnSoilAloneHardGroundsParametersDoNotVaryAndHaveNoAttribution) {
  const RunGroup group = measure(without_);
  constexpr std::size_t kRigid = 0, kRoughness = 5;
  for (std::size_t i = 0; i < kTerrainSize; ++i) {
    const bool varies = i != kRigid && i != kRoughness;
    for (const char* list : {"deviation", "alone", "gradient_haa", "gradient_kfe"}) {
      EXPECT_EQ(group.lists.at(list).at(i) > 0.0, varies) << list << " " << i;
    }
  }
}

TEST_F(OraclesTest, TheCurriculumIsOpenAndEveryStateIsInABin) {
  const auto lists = measure(without_).lists;
  const std::vector<double>& states = lists.at("bin_states");
  EXPECT_EQ(lists.at("robots").at(0), 48.0);
  EXPECT_EQ(std::accumulate(states.begin(), states.end(), 0.0), lists.at("states").at(0));
  EXPECT_EQ(lists.at("states").at(0), 48.0 * 20.0);
  // The first of ten bins from 1 to 40 MN/m^3; a training that begins draws nothing below 10.
  EXPECT_NEAR(lists.at("bin_sigma_npm3").at(0), 1.2e6, 1e4);
  EXPECT_GT(states.at(0), 0.0);
}

TEST_F(OraclesTest, AnActorThatIgnoresTheTerrainHasNoAttributionToIt) {
  Model model = without_;
  const learner::LayerView& first = model.network.layout.actor().front();
  for (int k = 0; k < first.outputs; ++k) {
    float* const row = model.network.parameters.data() + first.weight + k * first.inputs;
    std::fill(row + first.inputs - kTerrainSize, row + first.inputs, 0.0f);
  }
  const RunGroup group = measure(model);
  EXPECT_EQ(group.runs.at("T").at(0), 0.0);
  EXPECT_EQ(group.lists.at("gradient_hfe").at(1), 0.0);
  EXPECT_GT(group.runs.at("o").at(0), 0.0);
}

TEST_F(OraclesTest, NumbersAreTheSameForAnyThreads) {
  EXPECT_EQ(to_json({{measure(with_history_, 1)}}).dump(),
            to_json({{measure(with_history_, 2)}}).dump());
}

}  // namespace
}  // namespace sandrunner::study
