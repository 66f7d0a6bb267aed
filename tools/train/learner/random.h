// SPDX-License-Identifier: BSD-3-Clause
// Counter-based random numbers: a value is a function of (seed, stream, a, b) and of nothing else,
// so that it does not depend on the order or the thread in which values are drawn, and nothing but
// a counter needs to be saved.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "rt/core/split_mix.h"

namespace sandrunner::learner {

/// What the numbers are for: streams of one seed are independent of each other.
enum class Stream : std::uint64_t { kInitialization = 1, kAction = 2, kShuffle = 3 };

/// 64 uniform bits of counter (a, b), by SplitMix64.
constexpr std::uint64_t counter_bits(std::uint64_t seed, Stream stream, std::uint64_t a,
                                     std::uint64_t b) {
  std::uint64_t key = next_bits(seed) + static_cast<std::uint64_t>(stream);
  std::uint64_t row = next_bits(key) + a;
  std::uint64_t element = next_bits(row) + b;
  return next_bits(element);
}

/// Two independent standard normal values of counter (a, b) (Box and Muller 1958), |value| < 5.8.
inline std::pair<float, float> random_normal_pair(std::uint64_t seed, Stream stream,
                                                  std::uint64_t a, std::uint64_t b) {
  const std::uint64_t bits = counter_bits(seed, stream, a, b);
  constexpr float kUnit = 0x1p-24f;
  const float u = (static_cast<float>(bits >> 40) + 1.0f) * kUnit;        // (0, 1]
  const float v = static_cast<float>((bits >> 8) & 0xffffffULL) * kUnit;  // [0, 1)
  const float radius = std::sqrt(-2.0f * std::log(u));
  const float angle = 2.0f * std::numbers::pi_v<float> * v;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace sandrunner::learner
