// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "random_rollout.h"
#include "tools/train/learner/block_pass.h"
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

/// Of encoder, estimator and actor.
std::vector<NamedTensor> networks_of(NetworkParameters& policy) {
  std::vector<NamedTensor> tensors = tensors_of(policy);
  std::erase_if(tensors, [](const NamedTensor& t) { return t.name.starts_with("observation."); });
  return tensors;
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
    for (const NamedTensor& tensor : networks_of(policy)) {
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

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// The deployed network written out from PyTorch's documentation, on the exported tensors.
class PlainPolicy {
 public:
  explicit PlainPolicy(NetworkParameters policy) {
    for (const NamedTensor& tensor : networks_of(policy)) {
      tensors_[tensor.name] = std::vector<double>(tensor.values->begin(), tensor.values->end());
    }
    const std::size_t hidden = tensors_.at("encoder.bias_ih").size() / 4;
    h.assign(hidden, 0.0);
    c.assign(hidden, 0.0);
  }

  std::vector<double> step(const std::vector<double>& observation) {
    const std::vector<double> x(observation.begin() + kCommandSize, observation.end());
    std::vector<double> gates = affine("encoder.weight_ih", "encoder.bias_ih", x);
    const std::vector<double> recurrent = affine("encoder.weight_hh", "encoder.bias_hh", h);
    const std::size_t n = h.size();
    for (std::size_t k = 0; k < gates.size(); ++k) gates[k] += recurrent[k];
    for (std::size_t k = 0; k < n; ++k) {
      c[k] = sigmoid(gates[n + k]) * c[k] + sigmoid(gates[k]) * std::tanh(gates[2 * n + k]);
      h[k] = sigmoid(gates[3 * n + k]) * std::tanh(c[k]);
    }
    std::vector<double> input(observation.begin(), observation.begin() + kCommandSize);
    input.insert(input.end(), h.begin(), h.end());
    const std::vector<double> estimate = mlp("estimator", h);
    input.insert(input.end(), estimate.begin(), estimate.end());
    return mlp("actor", input);
  }

  std::vector<double> h;
  std::vector<double> c;

 private:
  std::vector<double> affine(const std::string& weight, const std::string& bias,
                             const std::vector<double>& x) const {
    std::vector<double> y = tensors_.at(bias);
    for (std::size_t row = 0; row < y.size(); ++row) {
      for (std::size_t col = 0; col < x.size(); ++col) {
        y[row] += tensors_.at(weight)[row * x.size() + col] * x[col];
      }
    }
    return y;
  }
  std::vector<double> mlp(const std::string& name, std::vector<double> x) const {
    for (int i = 0; i < 3; ++i) {
      const std::string layer = name + "." + std::to_string(i);
      x = affine(layer + ".weight", layer + ".bias", x);
      for (double& value : x) {
        if (i < 2 && value < 0.0) value *= 0.01;
      }
    }
    return x;
  }
  std::map<std::string, std::vector<double>> tensors_;
};

TEST(BlockPassTest, ActsAsAPlainPolicyOnTheExportedNetworksDoes) {
  const NetworkSizes sizes{16, {12, 10}, {20, 14}, {8}};
  const RolloutShape shape{4, 6, 5};
  const ParameterLayout layout(sizes, shape.privileged);
  const std::vector<double> exact = random_parameters(layout);
  const std::vector<float> parameters(exact.begin(), exact.end());
  Rollout rollout = random_rollout<float>(shape, layout.memory());
  BlockPass<float> pass(layout, 1, 2, 1);
  Weights<float> weights(layout);
  weights.set(parameters.data());
  const int first = 2;  // block: environments 2 and 3
  Matrix<float> memory = Matrix<float>::Zero(layout.memory(), 2);
  PlainPolicy plain(policy_of(layout, parameters));
  const int env = 3;
  for (int t = 0; t < shape.steps; ++t) {
    pass.act(weights, rollout, t, first, memory);
    if (rollout.reset(t, env) != 0) {
      plain.h.assign(plain.h.size(), 0.0);
      plain.c.assign(plain.c.size(), 0.0);
    }
    const auto observation = rollout.observation(t).col(env);
    const std::vector<double> expected =
        plain.step(std::vector<double>(observation.begin(), observation.end()));
    for (int k = 0; k < kActionSize; ++k) {
      EXPECT_NEAR(rollout.mean(t)(k, env), expected[static_cast<std::size_t>(k)], 1e-5);
    }
  }
  EXPECT_NEAR(memory(0, 1), plain.h[0], 1e-5);
  EXPECT_NEAR(memory(sizes.hidden, 1), plain.c[0], 1e-5);
}

}  // namespace
}  // namespace sandrunner::learner
