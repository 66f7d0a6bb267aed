// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <xmmintrin.h>

namespace sandrunner {

/// Makes the calling thread flush denormal results and inputs to zero. Denormals cost up to fifty
/// times a normal operation and would change bits between threads that flush and threads that do
/// not: every thread that runs a controller, policy or simulator step calls this first.
inline void flush_denormals_to_zero() noexcept {
  constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
}

}  // namespace sandrunner
