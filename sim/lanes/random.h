// SPDX-License-Identifier: BSD-3-Clause
// Counter-based random numbers: a value is a function of (seed, stream, counter) alone, so that
// draws do not depend on order, lanes or threads, and a snapshot needs no generator state.
#pragma once

#include <cstdint>

#include "rt/core/split_mix.h"
#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

/// 64 random bits: two rounds of the SplitMix64 finaliser over the mixed key.
inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream,
                                 std::uint64_t counter) noexcept {
  const std::uint64_t key = mix_bits(seed * kGoldenRatio + 0x632BE59BD9B4E019u) ^
                            mix_bits(stream * 0xD1B54A32D192ED03u + 0x8CB92BA72F3D8DD7u);
  return mix_bits(mix_bits(key + counter * kGoldenRatio) ^ key);
}

/// Uniform in [0, 1).
inline double random_uniform(std::uint64_t seed, std::uint64_t stream,
                             std::uint64_t counter) noexcept {
  return static_cast<double>(random_bits(seed, stream, counter) >> 11) * 0x1.0p-53;
}

/// Close to standard normal: the sum of twelve 16-bit uniforms, from three draws (excess kurtosis
/// -0.1, within +-6). No logarithm, so the same bits everywhere.
inline double random_normal(std::uint64_t seed, std::uint64_t stream,
                            std::uint64_t counter) noexcept {
  std::uint64_t sum = 0;
  for (std::uint64_t draw = 0; draw < 3; ++draw) {
    std::uint64_t bits = random_bits(seed, stream, 3 * counter + draw);
    for (int i = 0; i < 4; ++i, bits >>= 16) sum += bits & 0xFFFFu;
  }
  return (static_cast<double>(sum) + 6.0) * 0x1.0p-16 - 6.0;
}

}  // namespace sandrunner::sim
