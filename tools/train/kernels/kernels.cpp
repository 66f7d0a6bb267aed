// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/kernels/kernels.h"

#include "rt/core/processor.h"
#include "tools/train/kernels/lstm_kernel.h"

namespace sandrunner::learner {

const Kernels<double>& kernels_double() noexcept {
  static constexpr Kernels<double> kKernels = detail::make_kernels<double, 3, 2>();
  return kKernels;
}

template <>
const Kernels<float>& best_kernels() noexcept {
  return has_avx512() ? kernels_x16() : kernels_x8();
}
template <>
const Kernels<double>& best_kernels() noexcept {
  return kernels_double();
}

}  // namespace sandrunner::learner
