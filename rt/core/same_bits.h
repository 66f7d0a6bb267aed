// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace sandrunner {

inline bool same_bits(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

template <std::size_t kSize>
bool same_bits(const std::array<double, kSize>& a, const std::array<double, kSize>& b) noexcept {
  for (std::size_t i = 0; i < kSize; ++i) {
    if (!same_bits(a[i], b[i])) return false;
  }
  return true;
}

}  // namespace sandrunner
