// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/imu_look.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace sandrunner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// What is said of an IMU that delivers `sample` 500 times in a second.
std::vector<std::string> problems_of(const ImuSample& sample, std::uint64_t streamed = 500) {
  ImuLook look;
  for (int i = 0; i < 100; ++i) look.add(sample);
  return imu_problems(look.figures(streamed, 1.0), 500.0);
}

ImuSample level() {
  ImuSample sample;
  sample.linear_acceleration_mps2 = {0.0, 0.0, 9.81};
  return sample;
}

/// Turned by `angle_rad` about x: gravity and attitude alike.
ImuSample rolled(double angle_rad) {
  ImuSample sample;
  sample.orientation_wxyz = {std::cos(angle_rad / 2), std::sin(angle_rad / 2), 0.0, 0.0};
  sample.linear_acceleration_mps2 = {0.0, 9.81 * std::sin(angle_rad), 9.81 * std::cos(angle_rad)};
  return sample;
}

TEST(ImuLookTest, ALevelRobotAtRestIsGood) {
  EXPECT_THAT(problems_of(level()), IsEmpty());
  EXPECT_THAT(problems_of(rolled(0.2)), IsEmpty());
  ImuLook look;
  look.add(rolled(0.2));
  EXPECT_NEAR(look.figures(500, 1.0).tilt_rad, 0.2, 1e-9);
  EXPECT_NEAR(look.figures(500, 1.0).attitude_error_rad, 0.0, 1e-7);
}

TEST(ImuLookTest, AWrongMountingTurnsGravity) {
  EXPECT_THAT(problems_of(rolled(M_PI)), ElementsAre(HasSubstr("180 degrees from the body's z")));
}

TEST(ImuLookTest, WrongFiguresAreNamed) {
  EXPECT_THAT(imu_problems({}, 500.0), ElementsAre("no sample came"));
  EXPECT_THAT(problems_of(level(), 400), ElementsAre(HasSubstr("400 samples/s came of 500")));
  ImuSample sample = level();
  sample.linear_acceleration_mps2[2] = 1.0;  // in g
  EXPECT_THAT(problems_of(sample), ElementsAre(HasSubstr("1.00 m/s^2 at rest")));
  sample = level();
  sample.angular_velocity_radps = {0.0, 0.1, 0.0};
  EXPECT_THAT(problems_of(sample), ElementsAre(HasSubstr("turns by 0.100 rad/s")));
  sample = rolled(0.3);
  sample.linear_acceleration_mps2 = level().linear_acceleration_mps2;
  EXPECT_THAT(problems_of(sample), ElementsAre(HasSubstr("differ by 17 degrees")));
}

TEST(FrontLiftTest, TellsAnImuThatIsTurnedInItsMounting) {
  const double c = 9.81 * std::cos(0.35), s = 9.81 * std::sin(0.35);
  const Vector3 level{0.3, -0.2, 9.8};
  EXPECT_TRUE(judge_front_lift(level, {s, 0.0, c}).good);
  EXPECT_THAT(judge_front_lift(level, {s, 0.0, c}).words, HasSubstr("as it should"));
  const std::pair<Vector3, const char*> cases[] = {
      {{0.0, s, c}, "the left side lifted"},
      {{0.0, -s, c}, "the right side lifted"},
      {{-s, 0.0, c}, "the back lifted"},
      {{-s, -0.2, c}, "mounting_rpy_deg"},
      {{0.5, 0.0, 9.8}, "lifted by 2 degrees where about 20"},
  };
  for (const auto& [lifted, words] : cases) {
    EXPECT_FALSE(judge_front_lift(level, lifted).good);
    EXPECT_THAT(judge_front_lift(level, lifted).words, HasSubstr(words));
  }
}

}  // namespace
}  // namespace sandrunner
