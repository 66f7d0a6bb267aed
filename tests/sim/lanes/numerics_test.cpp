// SPDX-License-Identifier: BSD-3-Clause
// The simulator's own sine, cosine and quaternion integration against long double.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/lanes/vec.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

/// Difference in units of the last place of the double nearest to `exact`.
double ulps(double value, long double exact) {
  const double nearest = std::fabs(static_cast<double>(exact));
  const double ulp = std::nextafter(nearest, 1e300) - nearest;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - exact) / ulp);
}

double worst_ulps(double range, std::uint64_t seed) {
  Draw draw(seed);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double x = draw(-range, range);
    double s, c;
    sincos(x, s, c);
    worst = std::fmax(worst, std::fmax(ulps(s, std::sin(static_cast<long double>(x))),
                                       ulps(c, std::cos(static_cast<long double>(x)))));
  }
  return worst;
}

TEST(SincosTest, DoubleIsWithinAFewUlps) {
  EXPECT_LT(worst_ulps(10.0, 1), 2.0);
  EXPECT_LT(worst_ulps(1e4, 2), 3.0);
}

TEST(SincosTest, DoubleIsWithinTwoUlpsBesideMultiplesOfHalfPi) {
  // Where the reduced argument is small against x, the reduction shows its error.
  double worst = 0.0;
  for (int k = -6000; k <= 6000; ++k) {
    double x = k * (std::numbers::pi / 2.0);
    for (int i = 0; i < 4; ++i, x = std::nextafter(x, 1e9)) {
      double s, c;
      sincos(x, s, c);
      worst = std::fmax(worst, std::fmax(ulps(s, std::sin(static_cast<long double>(x))),
                                         ulps(c, std::cos(static_cast<long double>(x)))));
    }
  }
  EXPECT_LT(worst, 2.0);
}

TEST(SincosTest, FloatIsWithinOneAndAHalfTenMillionths) {
  Draw draw(3);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const float x = static_cast<float>(draw(-10.0, 10.0));
    float s, c;
    sincos(x, s, c);
    worst = std::fmax(worst, std::fmax(std::fabs(s - std::sin(static_cast<double>(x))),
                                       std::fabs(c - std::cos(static_cast<double>(x)))));
  }
  EXPECT_LT(worst, 1.5e-7);
}

TEST(SincosTest, ZeroIsExact) {
  double s, c;
  sincos(0.0, s, c);
  EXPECT_EQ(s, 0.0);
  EXPECT_EQ(c, 1.0);
}

TEST(ExponentialTest, IsWithinItsErrorFromZeroToSeven) {
  double worst = 0.0, worst_float = 0.0;
  for (double x = 0.0; x <= 7.0; x += 1e-4) {
    const double exact = std::exp(x);
    const double narrow_exact = std::exp(static_cast<double>(static_cast<float>(x)));
    worst = std::fmax(worst, std::fabs(exponential(x) / exact - 1.0));
    worst_float =
        std::fmax(worst_float, std::fabs(exponential(static_cast<float>(x)) / narrow_exact - 1.0));
  }
  EXPECT_LT(worst, 1e-14);
  EXPECT_LT(worst_float, 2e-6);
  EXPECT_EQ(exponential(0.0), 1.0);
}

/// q (x) exp(w/2) in long double with the library's sine and cosine.
std::array<long double, 4> exact_turn(const Quaternion<double>& q, const Vec3<double>& w) {
  const long double x = w.x, y = w.y, z = w.z;
  const long double angle = std::sqrt(x * x + y * y + z * z);
  const long double f = angle > 0.0L ? std::sin(angle / 2) / angle : 0.5L, c = std::cos(angle / 2);
  const long double v[3] = {f * x, f * y, f * z};
  return {q.w * c - q.x * v[0] - q.y * v[1] - q.z * v[2],
          q.w * v[0] + q.x * c + q.y * v[2] - q.z * v[1],
          q.w * v[1] + q.y * c + q.z * v[0] - q.x * v[2],
          q.w * v[2] + q.z * c + q.x * v[1] - q.y * v[0]};
}

TEST(QuaternionTest, IntegratesTheExponentialMap) {
  // The header allows rotations up to 0.5 rad; at 0.05 rad (200 rad/s) the series is exact to
  // rounding.
  Draw draw(4);
  double worst_small = 0.0, worst_large = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const Quaternion<double> q = random_state(draw).orientation;
    const bool small = i % 2 == 0;
    const Vec3<double> w = draw.vector(small ? 0.028 : 0.28);
    const Quaternion<double> r = integrate(q, w);
    const std::array<long double, 4> exact = exact_turn(q, w);
    const double ours[4] = {r.w, r.x, r.y, r.z};
    for (int k = 0; k < 4; ++k) {
      const double error = static_cast<double>(std::fabs(ours[k] - exact[k]));
      double& worst = small ? worst_small : worst_large;
      worst = std::fmax(worst, error);
    }
    EXPECT_NEAR(r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z, 1.0, 1e-15);
  }
  EXPECT_LT(worst_small, 5e-16);
  EXPECT_LT(worst_large, 1e-9);
}

TEST(QuaternionTest, TurnsOnceAroundInAThousandSteps) {
  // Constant rate about a fixed axis is exact for the exponential map: back to the start after 2
  // pi.
  Quaternion<double> q;
  const double step = 2.0 * std::numbers::pi / 1000.0;
  for (int i = 0; i < 1000; ++i) q = integrate(q, Vec3<double>{0.6 * step, 0.0, 0.8 * step});
  EXPECT_NEAR(std::fabs(q.w), 1.0, 1e-13);
  EXPECT_NEAR(q.x, 0.0, 1e-13);
  EXPECT_NEAR(q.z, 0.0, 1e-13);
}

TEST(RandomTest, NormalHasTheMomentsItClaims) {
  double sum = 0.0, square = 0.0, fourth = 0.0, largest = 0.0;
  const int n = 400000;
  for (int i = 0; i < n; ++i) {
    const double x = random_normal(7, 3, i);
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
    largest = std::fmax(largest, std::fabs(x));
  }
  EXPECT_NEAR(sum / n, 0.0, 4.0 / std::sqrt(n));
  EXPECT_NEAR(square / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n / (square / n) / (square / n) - 3.0, -0.1, 0.03);
  EXPECT_LT(largest, 6.0);
}

TEST(RandomTest, UniformFillsItsRangeAndStreamsDiffer) {
  std::array<int, 20> count{};
  const int n = 200000;
  double product = 0.0;
  for (int i = 0; i < n; ++i) {
    const double u = random_uniform(1, 2, i);
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++count[static_cast<int>(20.0 * u)];
    product += (u - 0.5) * (random_uniform(1, 3, i) - 0.5);
  }
  for (const int c : count) EXPECT_NEAR(c, n / 20.0, 5.0 * std::sqrt(n / 20.0));
  EXPECT_NEAR(product / n, 0.0, 5.0 / 12.0 / std::sqrt(n));
}

}  // namespace
}  // namespace sandrunner::sim
