// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/fma_peak.h"

namespace sandrunner::bench {

void fma_loop_x16(long loops) noexcept { fma_loop<16>(loops); }

}  // namespace sandrunner::bench
