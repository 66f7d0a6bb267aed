// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/exact_fma.h"

#include <cmath>
#include <cstdint>

#include "rt/core/split_mix.h"

namespace sandrunner {
namespace {

// Numbers of all sizes within an exponent of zero, of both signs, many with few bits.
class Numbers {
 public:
  double next(int exponent) {
    const std::uint64_t word = mix_bits(++counter_ * kGoldenRatio);
    const int shift = static_cast<int>(word % 52);
    const double share = 1.0 + static_cast<double>(word >> 12 >> shift << shift) * 0x1p-52;
    const int size = static_cast<int>(mix_bits(word) % static_cast<std::uint64_t>(2 * exponent));
    return std::ldexp((word & 0x800) != 0 ? share : -share, size - exponent);
  }

 private:
  std::uint64_t counter_ = 0;
};

template <typename Real>
bool is_fused(Real a, Real b, Real c) {
  const Real found = exact_fma(a, b, c), expected = std::fma(a, b, c);
  return found == expected && std::signbit(found) == std::signbit(expected);
}

TEST(ExactFmaTest, IsTheProcessorsInDouble) {
  Numbers numbers;
  for (int exponent : {1, 3, 60, 400}) {
    for (int i = 0; i < 200'000; ++i) {
      const double a = numbers.next(exponent), b = numbers.next(exponent);
      // Any addend; one that cancels the product; one half a last place beside it.
      for (const double c : {numbers.next(exponent), -a * b, a * b * 0x1p-53, -a * b * 0x1p-54}) {
        ASSERT_TRUE(is_fused(a, b, c)) << std::hexfloat << a << " " << b << " " << c;
      }
    }
  }
}

TEST(ExactFmaTest, IsTheProcessorsInFloat) {
  Numbers numbers;
  const auto next = [&](int exponent) { return static_cast<float>(numbers.next(exponent)); };
  for (int exponent : {1, 3, 30}) {
    for (int i = 0; i < 200'000; ++i) {
      const float a = next(exponent), b = next(exponent);
      for (const float c : {next(exponent), -a * b, a * b * 0x1p-24f, -a * b * 0x1p-25f}) {
        ASSERT_TRUE(is_fused(a, b, c)) << std::hexfloat << a << " " << b << " " << c;
      }
    }
  }
}

TEST(ExactFmaTest, KeepsTheSignOfZero) {
  for (const double a : {0.0, -0.0, 1.5}) {
    for (const double b : {0.0, -0.0, -2.0}) {
      for (const double c : {0.0, -0.0, 3.0, -a * b}) {
        EXPECT_TRUE(is_fused(a, b, c)) << a << " " << b << " " << c;
        EXPECT_TRUE(is_fused(float(a), float(b), float(c))) << a << " " << b << " " << c;
      }
    }
  }
}

}  // namespace
}  // namespace sandrunner
