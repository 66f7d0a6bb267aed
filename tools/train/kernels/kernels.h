// SPDX-License-Identifier: BSD-3-Clause
// The learner's inner loops, one set of functions for each instruction set, all giving the same
// bits: every element is computed by the same IEEE operations in the same order, a product's sum in
// the order of its index, each term by a fused multiply-add.
#pragma once

#include <cstddef>

#include "tools/train/kernels/panels.h"

namespace sandrunner::learner {

/// Slope of leaky ReLU for negative input (paper's networks).
template <typename Scalar>
inline constexpr Scalar kLeakySlope = static_cast<Scalar>(0.01);

/// Rows of a matrix, each contiguous, `stride` apart.
template <typename Scalar>
struct Rows {
  Scalar* data = nullptr;
  std::ptrdiff_t stride = 0;
};

/// What is made of each element of a product before it is written.
enum class Finish {
  kNone,
  kLeakyRelu,
  kLeakyReluBackward,  ///< times the slope where the activated output is not above zero
};

/// C = start + A B, one sample a row: A is samples x depth of `b`, C samples x columns of `b`.
template <typename Scalar>
struct Product {
  int samples = 0;
  Rows<const Scalar> a;
  const Panels<Scalar>& b;
  Rows<Scalar> c;
  bool add = false;  ///< starts from what C holds instead of from b's start
  Finish finish = Finish::kNone;
  Rows<const Scalar> activated = {};  ///< for kLeakyReluBackward: outputs, like C
};

/// C += A^T B over samples: A is samples x rows of C, B samples x columns of C.
template <typename Scalar>
struct GradientProduct {
  int samples = 0;
  int rows = 0;
  int columns = 0;
  Rows<const Scalar> a;
  Rows<const Scalar> b;
  Rows<Scalar> c;
};

template <typename Scalar>
struct Kernels {
  void (*multiply)(const Product<Scalar>& product);
  void (*add_gradient)(const GradientProduct<Scalar>& product);
  /// sum (columns) += all rows of x (samples x columns)
  void (*add_samples)(int samples, int columns, Rows<const Scalar> x, Scalar* sum);

  /// For each sample (all contiguous; gates 4 units long: i, f, g, o before activation; the others
  /// `units`): activates the gates; c' = f c + i g, tanh(c'), h' = o tanh(c').
  void (*lstm_forward)(int samples, int units, Scalar* gates, const Scalar* c, Scalar* next_c,
                       Scalar* tanh_c, Scalar* h);
  /// Activated gates -> gradient before activation; dh: gradient of h'; dc: of c' on entry, of c on
  /// return.
  void (*lstm_backward)(int samples, int units, Scalar* gates, const Scalar* c,
                        const Scalar* tanh_c, const Scalar* dh, Scalar* dc);
};

/// float in packs of 8 (AVX2, NEON).
const Kernels<float>& kernels_x8() noexcept;
/// float in packs of 16: only where has_avx512().
const Kernels<float>& kernels_x16() noexcept;
/// double, one by one, with the C library's exponential: to check against finite differences.
const Kernels<double>& kernels_double() noexcept;

/// The fastest that this processor can run.
template <typename Scalar>
const Kernels<Scalar>& best_kernels() noexcept;

}  // namespace sandrunner::learner
