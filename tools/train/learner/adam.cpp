// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/adam.h"

#include <cmath>

namespace sandrunner::learner {
namespace {

constexpr double kBeta1 = 0.9;
constexpr double kBeta2 = 0.999;
constexpr float kEpsilon = 1e-8f;

}  // namespace

void Adam::update(std::size_t begin, std::size_t end, double learning_rate, float gradient_scale,
                  const float* gradient, float* parameters) {
  const auto steps = static_cast<double>(step);
  // Corrections for the moments' start at zero.
  const auto rate = static_cast<float>(learning_rate / (1.0 - std::pow(kBeta1, steps)));
  const auto v_scale = static_cast<float>(1.0 / (1.0 - std::pow(kBeta2, steps)));
  constexpr auto kB1 = static_cast<float>(kBeta1);
  constexpr auto kB2 = static_cast<float>(kBeta2);
  for (std::size_t i = begin; i < end; ++i) {
    const float g = gradient_scale * gradient[i];
    m[i] = kB1 * m[i] + (1.0f - kB1) * g;
    v[i] = kB2 * v[i] + (1.0f - kB2) * g * g;
    parameters[i] -= rate * m[i] / (std::sqrt(v[i] * v_scale) + kEpsilon);
  }
}

}  // namespace sandrunner::learner
