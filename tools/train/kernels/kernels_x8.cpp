// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/kernels/kernels.h"
#include "tools/train/kernels/lstm_kernel.h"

namespace sandrunner::learner {

const Kernels<float>& kernels_x8() noexcept {
  // 12 of 16 registers hold the tile.
  static constexpr Kernels<float> kKernels = detail::make_kernels<sim::Pack<8>, 6, 2>();
  return kKernels;
}

}  // namespace sandrunner::learner
