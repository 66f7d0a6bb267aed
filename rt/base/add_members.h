// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>

namespace sandrunner {

/// Adds `more` to `sum`, member by member. T: all of its members are Number, or arrays of it.
template <typename Number, typename T>
void add_members(const T& more, T& sum) noexcept {
  using Numbers = std::array<Number, sizeof(T) / sizeof(Number)>;
  const auto added = std::bit_cast<Numbers>(more);
  auto numbers = std::bit_cast<Numbers>(sum);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += added[i];
  sum = std::bit_cast<T>(numbers);
}

}  // namespace sandrunner
