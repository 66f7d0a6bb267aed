// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "rt/core/split_mix.h"

namespace sandrunner {

/// 64-bit hash of state, word by word: equal bits give equal values on every machine and from every
/// compiler. Finds accidental differences; no protection against intent. Steps of the word: xor,
/// odd multiplier (golden ratio), xor-shift; the end is the finaliser of SplitMix64.
class StateHash {
 public:
  static_assert(std::endian::native == std::endian::little);

  /// Adds the bytes of `object`, whose type must have no padding: its size is a multiple of 8
  /// (widen single small members to 64 bits), and its author keeps members from leaving gaps.
  template <typename T>
  void add(const T& object) noexcept {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    static_assert(sizeof(T) % 8 == 0,
                  "a size that is no multiple of 8 has padding or needs widening");
    const auto* bytes = reinterpret_cast<const unsigned char*>(&object);
    for (std::size_t at = 0; at < sizeof(T); at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + at, 8);
      add_word(word);
    }
  }

  std::uint64_t value() const noexcept { return mix_bits(hash_); }

 private:
  void add_word(std::uint64_t word) noexcept {
    hash_ = (hash_ ^ word) * kGoldenRatio;
    hash_ ^= hash_ >> 32;
  }

  std::uint64_t hash_ = 0x53414E4452554E52u;  // any fixed non-zero start
};

}  // namespace sandrunner
