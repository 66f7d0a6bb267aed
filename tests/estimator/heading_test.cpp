// SPDX-License-Identifier: BSD-3-Clause
#include "estimator/heading.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

template <typename T>
class HeadingTest : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(HeadingTest, Scalars);

// A base that has turned left by 90 degrees and pitched: its x axis seen from above is short.
TYPED_TEST(HeadingTest, VelocityIsForwardAndToTheLeftWhateverThePitch) {
  using T = TypeParam;
  const Horizontal<T> velocity{T(-2), T(3)};
  for (const T length : {T(1), T(0.25)}) {
    const Horizontal<T> v = in_heading_frame<T>({T(0), length}, velocity);
    EXPECT_EQ(v[0], T(3));
    EXPECT_EQ(v[1], T(2));
    const Horizontal<T> direction = heading_direction<T>({T(0), length});
    EXPECT_EQ(components_along(direction, velocity), v);
  }
}

TYPED_TEST(HeadingTest, SpeedIsThatInTheWorld) {
  using T = TypeParam;
  const Horizontal<T> v = in_heading_frame<T>({T(0.3), T(-0.7)}, {T(1.5), T(2)});
  EXPECT_NEAR(v[0] * v[0] + v[1] * v[1], T(6.25), 1e-5);
}

TYPED_TEST(HeadingTest, VerticalBaseHasAFiniteVelocity) {
  using T = TypeParam;
  const Horizontal<T> v = in_heading_frame<T>({T(0), T(0)}, {T(1), T(1)});
  EXPECT_EQ(v, (Horizontal<T>{T(0), T(0)}));
  EXPECT_EQ(heading_direction<T>({T(0), T(0)}), (Horizontal<T>{T(0), T(0)}));
}

}  // namespace
}  // namespace sandrunner
