// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/base/clock_ns.h"

namespace sandrunner::bench {

/// Processor time that the calling thread takes for `work`, s: what others do on the machine is not
/// in it.
template <typename Work>
double cpu_time_s(const Work& work) {
  const double start_s = clock_s(CLOCK_THREAD_CPUTIME_ID);
  work();
  return clock_s(CLOCK_THREAD_CPUTIME_ID) - start_s;
}

}  // namespace sandrunner::bench
