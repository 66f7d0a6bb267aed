// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sandrunner::sim {

/// Whether this processor can run what is compiled for x86-64-v4. All of the program is built for
/// x86-64-v3.
inline bool has_avx512() noexcept {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512cd");
}

}  // namespace sandrunner::sim
