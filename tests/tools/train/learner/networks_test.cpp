// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/train/learner/parameters.h"

namespace sandrunner::learner {
namespace {

TEST(ParametersTest, TensorsTileTheArray) {
  const ParameterLayout layout(NetworkSizes{}, 80);
  std::ptrdiff_t next = 0;
  for (const TensorView& tensor : layout.tensors()) {
    EXPECT_EQ(tensor.offset, next) << tensor.name;
    next += tensor.rows * tensor.cols;
  }
  EXPECT_EQ(layout.size(), next);
}

TEST(ParametersTest, StartWithTheStatedScalesAndForgetBias) {
  const ParameterLayout layout(NetworkSizes{}, 80);
  const std::vector<float> parameters = initial_parameters(layout, 1, 0.6);
  const auto rms = [&](std::ptrdiff_t offset, int count) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      sum += std::pow(parameters[static_cast<std::size_t>(offset + i)], 2);
    }
    return std::sqrt(sum / count);
  };
  EXPECT_NEAR(rms(layout.actor().back().weight, 12 * 128), 0.05 / std::sqrt(128.0), 2e-4);
  EXPECT_NEAR(rms(layout.critic().back().weight, 128), 0.3 / std::sqrt(128.0), 6e-3);
  EXPECT_NEAR(rms(layout.actor().front().weight, 256 * 75), std::sqrt(2.0 / 75.0), 3e-3);
  EXPECT_EQ(rms(layout.actor().front().bias, 256), 0.0);
  EXPECT_NEAR(rms(layout.log_std(), kActionSize), -std::log(0.6), 1e-6);
  const int cols = kProprioceptionSize + 1 + 64;
  for (int row = 0; row < 256; ++row) {  // i, f, g, o
    EXPECT_EQ(parameters[static_cast<std::size_t>(layout.encoder() + row * cols + 30)],
              row >= 64 && row < 128 ? 1.0f : 0.0f);
  }
}

NetworkParameters policy_of(const ParameterLayout& layout, const std::vector<float>& parameters) {
  NetworkParameters policy;
  to_policy(layout, parameters, policy);
  return policy;
}

const std::vector<Wiring> kWirings = {{},
                                      {EncoderKind::kTcn, {}},
                                      {EncoderKind::kInsight, {true, false, true, false}},
                                      {EncoderKind::kLstm, {false, true, true, true}}};

TEST(ParametersTest, APolicyGetsAsManyNumbersAsItsFileHas) {
  for (const Wiring& wiring : kWirings) {
    NetworkSizes sizes;
    sizes.wiring = wiring;
    const ParameterLayout layout(sizes, 80);
    NetworkParameters policy = policy_of(layout, initial_parameters(layout, 1, 0.6));
    for (const NamedTensor& tensor : tensors_of(policy)) {
      if (tensor.name.starts_with("observation.")) continue;  // of no network
      EXPECT_EQ(tensor.values->size(), tensor.size()) << wiring_text(wiring) << tensor.name;
    }
  }
}

TEST(ParametersTest, NetworksOfAPolicyComeBackAsTheyWere) {
  for (const Wiring& wiring : kWirings) {
    NetworkSizes sizes;
    sizes.wiring = wiring;
    const ParameterLayout layout(sizes, 80);
    const std::vector<float> from = initial_parameters(layout, 1, 0.6);
    std::vector<float> to = initial_parameters(layout, 2, 0.3);
    const std::vector<float> before = to;
    from_policy(policy_of(layout, from), layout, to);
    const std::ptrdiff_t critic = layout.critic().front().weight;
    EXPECT_TRUE(std::equal(to.begin(), to.begin() + critic, from.begin())) << wiring_text(wiring);
    EXPECT_TRUE(std::equal(to.begin() + critic, to.end(), before.begin() + critic));
  }
}

}  // namespace
}  // namespace sandrunner::learner
