// SPDX-License-Identifier: BSD-3-Clause
// Matrix types of the learner: column-major with one sample a column.
#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "tools/train/kernels/kernels.h"

namespace sandrunner::learner {

template <typename Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <typename Scalar>
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
template <typename Scalar>
using ConstMatrixRef = Eigen::Ref<const Matrix<Scalar>, 0, Eigen::OuterStride<>>;
template <typename Scalar>
using MatrixRef = Eigen::Ref<Matrix<Scalar>, 0, Eigen::OuterStride<>>;

/// A matrix as the kernels take it: a sample, here a column, is a row there.
template <typename M>
auto rows_of(M&& matrix) {
  return Rows<std::remove_pointer_t<decltype(matrix.data())>>{matrix.data(), matrix.outerStride()};
}

}  // namespace sandrunner::learner
