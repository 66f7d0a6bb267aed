// SPDX-License-Identifier: BSD-3-Clause
// What /odom says of a simulated robot, compared with what really is.
#include "estimator/odometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt/loop/lockstep.h"
#include "tests/rt/loop/faulty_robot.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/example_tick.h"

namespace sandrunner {
namespace {

/// Lies, stands up, walks, stops, walks again, breaks an encoder and falls.
class Day {
 public:
  explicit Day(const std::string& terrain)
      : policy_(load_shipped_policy()),
        config_(config_of(terrain, {}, policy_.spec())),
        simulator_(config_.robot, config_.simulator),
        robot_(simulator_, Drives::kGains),
        loop_(robot_, config_.controller, Mode::kPassive, policy_),
        odometry_(config_.robot.description) {
    simulator_.reset_lying();
  }

  template <typename Look>
  void live(const Look& look) {
    wait(0.6, look);
    ask(ModeRequest::kArm, Mode::kDamping, look);
    ask(ModeRequest::kStand, Mode::kStand, look);
    wait(1.0, look);
    ask(ModeRequest::kWalk, Mode::kWalk, look);
    command_.velocity = {.vx_mps = 2.0, .wz_radps = 0.3};
    wait(3.0, look);
    ask(ModeRequest::kStand, Mode::kStand, look);
    wait(1.0, look);
    ask(ModeRequest::kWalk, Mode::kWalk, look);
    wait(1.0, look);
    robot_.spoil = [](SensorFrame& frame, const SensorFrame&, std::uint64_t) {
      frame.joints.position_rad[4] = std::numeric_limits<double>::quiet_NaN();
    };
    wait(0.1, look);
    EXPECT_EQ(loop_.record().output.mode, Mode::kFault);
    robot_.spoil = nullptr;
    wait(3.0, look);
  }

  const Odometry& odometry() const { return odometry_; }

 private:
  template <typename Look>
  void wait(double time_s, const Look& look) {
    for (std::uint64_t ticks = ticks_from_s(time_s); ticks > 0; --ticks) {
      loop_.tick(command_);
      odometry_.add(loop_.record().input, loop_.record().output);
      look(loop_.record(), odometry_);
    }
  }
  template <typename Look>
  void ask(ModeRequest request, Mode mode, const Look& look) {
    command_.ask(request);
    for (int i = 0; i < 800 && loop_.record().output.mode != mode; ++i) wait(0.01, look);
    EXPECT_EQ(loop_.record().output.mode, mode);
  }

  PolicyRunner policy_;
  const ProcessConfig config_;
  sim::Simulator simulator_;
  FaultyRobot robot_;
  Lockstep loop_;
  Odometry odometry_;
  OperatorCommand command_;
};

class OdometryOfADayTest : public testing::TestWithParam<const char*> {};

TEST_P(OdometryOfADayTest, NoMessageIsFarFromTheOneBeforeInWhateverMode) {
  Day day(GetParam());
  Vector3 last_m{};
  double most_horizontal_m = 0.0, most_vertical_m = 0.0;
  bool first = true;
  day.live([&](const TickRecord& tick, const Odometry& odometry) {
    if (tick.input.sensors.tick % kTicksPerPolicyStep != 0) return;
    const Vector3& now_m = odometry.position_m();
    if (!first) {
      most_horizontal_m =
          std::max(most_horizontal_m, std::hypot(now_m[0] - last_m[0], now_m[1] - last_m[1]));
      most_vertical_m = std::max(most_vertical_m, std::fabs(now_m[2] - last_m[2]));
    }
    first = false;
    last_m = now_m;
  });
  EXPECT_LE(most_horizontal_m, 0.03);  // 3 m/s, at a mean of 2
  EXPECT_LE(most_vertical_m, 0.0101);  // 1 m/s
  std::printf("steps: %.1f mm horizontally, %.1f mm in height\n", 1e3 * most_horizontal_m,
              1e3 * most_vertical_m);
}

TEST_P(OdometryOfADayTest, TheTruthLiesWithinThreeStandardDeviationsOfWhatIsSaid) {
  Day day(GetParam());
  int known = 0, unknown = 0, wrong_velocity = 0, wrong_height = 0, wrong_place = 0;
  double worst_velocity = 0.0, worst_height = 0.0;
  day.live([&](const TickRecord& tick, const Odometry& odometry) {
    if (tick.input.sensors.tick % kTicksPerPolicyStep != 0) return;
    const auto twist = odometry.twist_covariance(), pose = odometry.pose_covariance();
    (twist[0] < 1.0 ? known : unknown) += 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double error_mps = tick.before.state.velocity_mps[i] - odometry.velocity_mps()[i];
      const double deviations = std::fabs(error_mps) / std::sqrt(twist[7 * i]);
      worst_velocity = std::max(worst_velocity, deviations);
      wrong_velocity += deviations > 3.0;
    }
    const double error_m = tick.truth.position_m[2] - odometry.position_m()[2];
    const double deviations = std::fabs(error_m) / std::sqrt(pose[14]);
    worst_height = std::max(worst_height, deviations);
    wrong_height += deviations > 3.0;
    const double x_m = tick.truth.position_m[0] - odometry.position_m()[0];
    const double y_m = tick.truth.position_m[1] - odometry.position_m()[1];
    wrong_place += std::hypot(x_m, y_m) > 3.0 * std::sqrt(pose[0]) + 0.01;
  });
  EXPECT_EQ(wrong_velocity, 0) << worst_velocity;
  EXPECT_EQ(wrong_height, 0) << worst_height;
  EXPECT_EQ(wrong_place, 0);
  EXPECT_GT(known, 500);    // walking, standing, lying
  EXPECT_GT(unknown, 200);  // standing up, falling
  std::printf("worst: velocity %.2f, height %.2f standard deviations\n", worst_velocity,
              worst_height);
}

INSTANTIATE_TEST_SUITE_P(On, OdometryOfADayTest, testing::Values("dry-sand", "rigid"),
                         [](const auto& instance) {
                           return std::string(instance.param).substr(0, 3);
                         });

TEST(OdometryOfTicksTest, WhereNothingIsKnownTheCovarianceIsLarge) {
  Odometry odometry(example_robot());
  for (std::uint64_t tick = 0; tick < 4000; ++tick) {
    TickRecord record = example_tick(tick);  // its joints turn
    record.output.mode = Mode::kStand;
    odometry.add(record.input, record.output);
  }
  EXPECT_EQ(odometry.velocity_mps(), Vector3{});
  EXPECT_EQ(odometry.twist_covariance()[0], kUnknownVariance);
  EXPECT_GT(odometry.pose_covariance()[0], 0.1);
  EXPECT_EQ(odometry.position_m()[0], 0.0);
}

TEST(OdometryOfTicksTest, AnImuThatMeasuresNothingStopsTheFrameWhereItIs) {
  Odometry odometry(example_robot());
  odometry.add(example_tick(0).input, example_tick(0).output);
  TickRecord broken = example_tick(1);
  broken.input.sensors.imu.orientation_wxyz.fill(std::numeric_limits<double>::quiet_NaN());
  odometry.add(broken.input, broken.output);
  EXPECT_EQ(odometry.orientation_wxyz(), example_tick(0).input.sensors.imu.orientation_wxyz);
  EXPECT_TRUE(std::isfinite(odometry.position_m()[0]));
}

TEST(OdometryOfTicksTest, TheHeightOfAStandingRobotIsThatOfItsBaseAboveItsLowestFoot) {
  Odometry odometry(example_robot());
  TickRecord record = example_tick(0);
  record.output.mode = Mode::kStand;
  record.input.sensors.joints.position_rad.fill(0.0);
  odometry.add(record.input, record.output);
  EXPECT_NEAR(odometry.position_m()[2], 0.01 + 0.4 + 0.02, 1e-12);
}

}  // namespace
}  // namespace sandrunner
