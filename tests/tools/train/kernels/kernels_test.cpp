// SPDX-License-Identifier: BSD-3-Clause
// The kernels of each instruction set against plain loops: to rounding in double, to the bit in
// float, where a plain loop of fused multiply-adds is the sum that they promise.
#include "tools/train/kernels/kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "rt/core/processor.h"

namespace sandrunner::learner {
namespace {

/// Not a multiple of any tile or pack; and those of the learner's layers.
struct Size {
  int samples, depth, columns;
};
const std::vector<Size> kSizes = {{1, 1, 1},    {1, 7, 5},    {2, 3, 33},    {13, 4, 16},
                                  {14, 9, 32},  {27, 31, 47}, {64, 95, 256}, {300, 64, 12},
                                  {65, 12, 65}, {5, 128, 1}};

template <typename Scalar>
std::vector<Scalar> random_values(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Scalar> values(count);
  for (Scalar& value : values) value = static_cast<Scalar>(normal(random));
  return values;
}

/// Row i, column j of a matrix with gaps between its rows.
template <typename Scalar>
struct Gapped {
  Gapped(int rows, int columns, unsigned seed)
      : stride(columns + 3), values(random_values<Scalar>(std::size_t(rows) * stride, seed)) {}
  Scalar& operator()(int i, int j) { return values[std::size_t(i) * stride + j]; }
  Rows<Scalar> rows() { return {values.data(), stride}; }
  Rows<const Scalar> const_rows() const { return {values.data(), stride}; }

  int stride;
  std::vector<Scalar> values;
};

template <typename Scalar>
Scalar leaky(Scalar sign, Scalar x) {
  return sign > 0 ? x : kLeakySlope<Scalar> * x;
}

/// b(k, j) is element (k, j) of a depth x columns matrix, or, transposed, (j, k) of the other.
template <typename Scalar>
Gapped<Scalar> product(const Kernels<Scalar>* kernels, const Size& size, bool transposed, bool add,
                       Finish finish) {
  Gapped<Scalar> a(size.samples, size.depth, 1), c(size.samples, size.columns, 3),
      activated(size.samples, size.columns, 5);
  Gapped<Scalar> b = transposed ? Gapped<Scalar>(size.columns, size.depth, 2)
                                : Gapped<Scalar>(size.depth, size.columns, 2);
  std::vector<Scalar> bias = random_values<Scalar>(std::size_t(size.columns), 4);
  if (kernels != nullptr) {
    Panels<Scalar> panels(size.depth, size.columns);
    panels.pack(b.values.data(), transposed ? 1 : b.stride, transposed ? b.stride : 1, bias.data());
    kernels->multiply({.samples = size.samples,
                       .a = a.const_rows(),
                       .b = panels,
                       .c = c.rows(),
                       .add = add,
                       .finish = finish,
                       .activated = activated.const_rows()});
    return c;
  }
  for (int i = 0; i < size.samples; ++i) {
    for (int j = 0; j < size.columns; ++j) {
      Scalar sum = add ? c(i, j) : bias[std::size_t(j)];
      for (int k = 0; k < size.depth; ++k) {
        sum = std::fma(a(i, k), transposed ? b(j, k) : b(k, j), sum);
      }
      if (finish == Finish::kLeakyRelu) sum = leaky(sum, sum);
      if (finish == Finish::kLeakyReluBackward) sum = leaky(activated(i, j), sum);
      c(i, j) = sum;
    }
  }
  return c;
}

/// depth: rows of C.
template <typename Scalar>
Gapped<Scalar> gradient_product(const Kernels<Scalar>* kernels, const Size& size) {
  Gapped<Scalar> a(size.samples, size.depth, 1), b(size.samples, size.columns, 2),
      c(size.depth, size.columns, 3);
  if (kernels != nullptr) {
    kernels->add_gradient({.samples = size.samples,
                           .rows = size.depth,
                           .columns = size.columns,
                           .a = a.const_rows(),
                           .b = b.const_rows(),
                           .c = c.rows()});
    return c;
  }
  for (int i = 0; i < size.depth; ++i) {
    for (int j = 0; j < size.columns; ++j) {
      for (int k = 0; k < size.samples; ++k) c(i, j) = std::fma(a(k, i), b(k, j), c(i, j));
    }
  }
  return c;
}

struct Cells {
  std::vector<float> gates, c, next_c, tanh_c, h, dc;
};

/// Both passes of LSTM cells.
Cells cells(const Kernels<float>& kernels, int samples, int units) {
  const auto n = std::size_t(samples) * units;
  Cells cells{random_values<float>(4 * n, 1), random_values<float>(n, 2),
              std::vector<float>(n),          std::vector<float>(n),
              std::vector<float>(n),          random_values<float>(n, 3)};
  kernels.lstm_forward(samples, units, cells.gates.data(), cells.c.data(), cells.next_c.data(),
                       cells.tanh_c.data(), cells.h.data());
  const std::vector<float> dh = random_values<float>(n, 4);
  kernels.lstm_backward(samples, units, cells.gates.data(), cells.c.data(), cells.tanh_c.data(),
                        dh.data(), cells.dc.data());
  return cells;
}

std::vector<float> sums(const Kernels<float>& kernels, int samples, int columns) {
  const Gapped<float> x(samples, columns, 1);
  std::vector<float> sum = random_values<float>(std::size_t(columns), 2);
  kernels.add_samples(samples, columns, x.const_rows(), sum.data());
  return sum;
}

/// Every kernel, at every size and with every variant, gives the bits of plain loops.
void expect_promised_bits(const Kernels<float>& kernels) {
  for (const Size& size : kSizes) {
    SCOPED_TRACE(testing::Message() << size.samples << " samples, depth " << size.depth << ", "
                                    << size.columns << " columns");
    for (const bool transposed : {false, true}) {
      for (const bool add : {false, true}) {
        for (const Finish finish :
             {Finish::kNone, Finish::kLeakyRelu, Finish::kLeakyReluBackward}) {
          EXPECT_EQ(product(&kernels, size, transposed, add, finish).values,
                    product<float>(nullptr, size, transposed, add, finish).values)
              << transposed << add << static_cast<int>(finish);
        }
      }
    }
    EXPECT_EQ(gradient_product(&kernels, size).values,
              gradient_product<float>(nullptr, size).values);
    Gapped<float> x(size.samples, size.columns, 1);
    std::vector<float> expected = random_values<float>(std::size_t(size.columns), 2);
    for (int i = 0; i < size.samples; ++i) {
      for (int j = 0; j < size.columns; ++j) expected[std::size_t(j)] += x(i, j);
    }
    EXPECT_EQ(sums(kernels, size.samples, size.columns), expected);
  }
}

TEST(KernelsTest, Avx2SumsInOrderAsAPlainLoopDoes) { expect_promised_bits(kernels_x8()); }

TEST(KernelsTest, Avx512SumsInOrderAsAPlainLoopDoes) {
  if (!has_avx512()) GTEST_SKIP() << "this processor has no AVX-512";
  expect_promised_bits(kernels_x16());
}

TEST(KernelsTest, FloatAndDoubleAreNearAPlainLoopInDouble) {
  const auto error = [](const auto& found, const auto& exact) {
    double worst = 0.0;
    for (std::size_t i = 0; i < exact.values.size(); ++i) {
      worst = std::max(worst, std::abs(double(found.values[i]) - double(exact.values[i])));
    }
    return worst;
  };
  for (const Size& size : kSizes) {
    const Finish none = Finish::kNone;
    const auto exact = product<double>(nullptr, size, false, false, none);
    EXPECT_LE(error(product(&kernels_double(), size, false, false, none), exact), 1e-12);
    EXPECT_LE(error(product(&best_kernels<float>(), size, false, false, none), exact), 3e-5);
    const auto exact_gradient = gradient_product<double>(nullptr, size);
    EXPECT_LE(error(gradient_product(&kernels_double(), size), exact_gradient), 1e-12);
    EXPECT_LE(error(gradient_product(&best_kernels<float>(), size), exact_gradient), 6e-5);
  }
}

TEST(KernelsTest, LstmCellsHaveTheSameBitsAtBothWidths) {
  if (!has_avx512()) GTEST_SKIP() << "this processor has no AVX-512";
  for (const int units : {1, 5, 8, 12, 16, 23, 64}) {
    const Cells a = cells(kernels_x8(), 7, units), b = cells(kernels_x16(), 7, units);
    EXPECT_EQ(a.gates, b.gates) << units;
    EXPECT_EQ(a.next_c, b.next_c) << units;
    EXPECT_EQ(a.tanh_c, b.tanh_c) << units;
    EXPECT_EQ(a.h, b.h) << units;
    EXPECT_EQ(a.dc, b.dc) << units;
  }
}

}  // namespace
}  // namespace sandrunner::learner
