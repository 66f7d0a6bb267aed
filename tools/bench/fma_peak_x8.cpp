// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/fma_peak.h"

namespace sandrunner::bench {

void fma_loop_x8(long loops) noexcept { fma_loop<8>(loops); }

}  // namespace sandrunner::bench
