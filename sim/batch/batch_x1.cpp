// SPDX-License-Identifier: BSD-3-Clause
#include "sim/batch/batch_kernel.h"
#include "sim/lanes/pack.h"

namespace sandrunner::sim::detail {

const BatchKernel& batch_kernel_x1() noexcept {
  static const BatchKernel kernel = make_kernel<float>();
  return kernel;
}

}  // namespace sandrunner::sim::detail
