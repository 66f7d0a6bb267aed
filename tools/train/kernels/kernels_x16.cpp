// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/kernels/kernels.h"
#include "tools/train/kernels/lstm_kernel.h"

namespace sandrunner::learner {

const Kernels<float>& kernels_x16() noexcept {
  // 26 of 32 registers hold the tile.
  static constexpr Kernels<float> kKernels = detail::make_kernels<sim::Pack<16>, 13, 2>();
  return kKernels;
}

}  // namespace sandrunner::learner
