// SPDX-License-Identifier: BSD-3-Clause
// The most that the kernels could do: nothing but fused multiply-adds, in registers.
#pragma once

#include "sim/lanes/pack.h"

namespace sandrunner::bench {

/// A loop makes that many multiply-adds of a pack each, enough to hide their latency.
inline constexpr int kPeakRegisters = 12;

/// `loops` loops with packs of 8 or of 16 lanes; of 16 only where has_avx512(). Each is in a source
/// of its own, which is compiled for its processor.
void fma_loop_x8(long loops) noexcept;
void fma_loop_x16(long loops) noexcept;

template <int kLanes>
inline void fma_loop(long loops) noexcept {
  volatile float unknown = 1e-9f;
  const sim::Pack<kLanes> x(static_cast<float>(unknown));
  sim::Pack<kLanes> sum[kPeakRegisters];
  // Each from a value of its own: of equal sums a compiler makes one.
  for (auto& pack : sum) pack = sim::Pack<kLanes>(static_cast<float>(unknown));
  for (; loops > 0; --loops) {
    for (auto& pack : sum) pack = fma(x, x, pack);
  }
  for (const auto& pack : sum) {
    float lanes[kLanes];
    store(pack, lanes);
    unknown = lanes[0];
  }
}

}  // namespace sandrunner::bench
