// SPDX-License-Identifier: BSD-3-Clause
// What is done otherwise on every kind of processor: x86-64 and 64-bit ARM.
#pragma once

#ifdef __aarch64__
#include <cstdint>
#else
#include <xmmintrin.h>
#endif

namespace sandrunner {

/// Makes the calling thread flush denormal results and inputs to zero. Denormals cost up to fifty
/// times a normal operation and would change bits between threads that flush and threads that do
/// not: every thread that runs a controller, policy or simulator step calls this first.
inline void flush_denormals_to_zero() noexcept {
#ifdef __aarch64__
  constexpr std::uint64_t kFlushToZero = 1U << 24;  // FPCR.FZ: inputs and results
  std::uint64_t control;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  asm volatile("msr fpcr, %0" : : "r"(control | kFlushToZero));
#else
  constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
#endif
}

/// Whether this processor can run what is compiled for x86-64-v4, packs of 16 lanes. On x86-64 all
/// of the program is built for x86-64-v3.
inline bool has_avx512() noexcept {
#ifdef __aarch64__
  return false;
#else
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512cd");
#endif
}

}  // namespace sandrunner
