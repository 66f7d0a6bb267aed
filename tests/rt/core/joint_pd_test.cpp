// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/joint_pd.h"

#include <gtest/gtest.h>

#include <limits>

namespace lanes {
// A pack with operations of its own, found by argument-dependent lookup as those of a SIMD type
// are.
struct Pack {
  double a, b;
};
Pack operator-(const Pack& x, const Pack& y) { return {x.a - y.a, x.b - y.b}; }
Pack fma(const Pack& x, const Pack& y, const Pack& z) {
  return {std::fma(x.a, y.a, z.a), std::fma(x.b, y.b, z.b)};
}
Pack min(const Pack& x, const Pack& y) { return {std::min(x.a, y.a), std::min(x.b, y.b)}; }
Pack max(const Pack& x, const Pack& y) { return {std::max(x.a, y.a), std::max(x.b, y.b)}; }
}  // namespace lanes

namespace sandrunner {
namespace {

TEST(JointPdTest, SumsThreeTerms) {
  EXPECT_EQ(joint_torque(0.25, 2.0, 0.5, 1.0, 50.0, 0.5, 3.0), 50.0 * 0.25 - 0.5 * 1.0 + 3.0);
}

TEST(JointPdTest, RoundsOncePerOperation) {
  const double q = 0.1, qd = -3.3, q_des = 0.7, qd_des = 0.2, kp = 49.7, kd = 0.53, ff = 1.1;
  const double expected = std::fma(kp, q_des - q, std::fma(kd, qd_des - qd, ff));
  EXPECT_EQ(joint_torque(q, qd, q_des, qd_des, kp, kd, ff), expected);
}

TEST(JointPdTest, PackGivesTheBitsOfItsLanes) {
  using lanes::Pack;
  const Pack torque = joint_torque<Pack>({0.1, -0.4}, {1.3, 2.1}, {0.2, 0.9}, {0.0, 0.1},
                                         {50.0, 100.0}, {0.5, 1.0}, {0.0, 2.0});
  EXPECT_EQ(torque.a, joint_torque(0.1, 1.3, 0.2, 0.0, 50.0, 0.5, 0.0));
  EXPECT_EQ(torque.b, joint_torque(-0.4, 2.1, 0.9, 0.1, 100.0, 1.0, 2.0));
  const Pack clamped = clamp_to<Pack>({70.0, -70.0}, {-63.45, -63.45}, {63.45, 63.45});
  EXPECT_EQ(clamped.a, 63.45);
  EXPECT_EQ(clamped.b, -63.45);
}

TEST(JointPdTest, ClampKeepsNanVisible) {
  EXPECT_TRUE(std::isnan(clamp_to(std::numeric_limits<double>::quiet_NaN(), -1.0, 1.0)));
  EXPECT_EQ(clamp_to(0.5, -1.0, 1.0), 0.5);
  EXPECT_EQ(clamp_to(-std::numeric_limits<double>::infinity(), -1.0, 1.0), -1.0);
}

}  // namespace
}  // namespace sandrunner
