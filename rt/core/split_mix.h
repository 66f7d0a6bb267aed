// SPDX-License-Identifier: BSD-3-Clause
// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): 64 bits that depend on all bits of a state.
#pragma once

#include <cstdint>

namespace sandrunner {

/// 2^64 over the golden ratio, odd.
inline constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;

/// The finaliser: a bijection whose output bits all depend on all input bits; 0 stays 0.
constexpr std::uint64_t mix_bits(std::uint64_t z) noexcept {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/// The next 64 uniform bits of the generator with this state.
constexpr std::uint64_t next_bits(std::uint64_t& state) noexcept {
  return mix_bits(state += kGoldenRatio);
}

}  // namespace sandrunner
