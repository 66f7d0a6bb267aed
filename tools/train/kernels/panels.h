// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sandrunner::learner {

/// Columns of a panel: two registers of AVX-512.
inline constexpr int kPanelColumns = 32;

/// The right-hand matrix B (depth x columns) of many products with the vector (a bias) that they
/// start from, in the order in which the kernels read them: panels of 32 columns, each the vector's
/// part and then one row of B after the other; zero past the last column.
template <typename Scalar>
class Panels {
 public:
  Panels() = default;
  Panels(int depth, int columns)
      : depth_(depth),
        columns_(columns),
        rows_(static_cast<std::size_t>((columns + kPanelColumns - 1) / kPanelColumns) *
              static_cast<std::size_t>(1 + depth)) {}

  int depth() const { return depth_; }
  int columns() const { return columns_; }

  /// B(k, j) = b[k * k_stride + j * j_stride]; start: one value a column, or none for zero.
  void pack(const Scalar* b, std::ptrdiff_t k_stride, std::ptrdiff_t j_stride,
            const Scalar* start = nullptr) {
    for (int first = 0; first < columns_; first += kPanelColumns) {
      const int width = std::min(kPanelColumns, columns_ - first);
      Row* row = rows_.data() + panel_row(first);
      if (start != nullptr) std::copy_n(start + first, width, row->value);
      for (int k = 0; k < depth_; ++k) {
        const Scalar* from = b + k * k_stride + first * j_stride;
        Scalar* to = row[1 + k].value;
        for (int j = 0; j < width; ++j) to[j] = from[j * j_stride];
      }
    }
  }

  /// The panel that begins with column `first`: its start, then its rows.
  const Scalar* panel(int first) const { return rows_[panel_row(first)].value; }

 private:
  struct alignas(64) Row {
    Scalar value[kPanelColumns] = {};
  };
  std::size_t panel_row(int first) const {
    return static_cast<std::size_t>(first / kPanelColumns) * static_cast<std::size_t>(1 + depth_);
  }

  int depth_ = 0;
  int columns_ = 0;
  std::vector<Row> rows_;
};

}  // namespace sandrunner::learner
