// SPDX-License-Identifier: BSD-3-Clause
// Every fault that judges sensors, at the corners of every legal rate of drives and IMU: none is
// off, and a good robot has none.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "outcome.h"
#include "tests/support/not_finite.h"

namespace sandrunner::attack {
namespace {

/// A configuration that the program accepts, and the rates at which its samples then come.
struct RateCorner {
  std::string name;
  std::string file;  ///< of --hardware
  std::vector<std::string> settings;
  SampleRates rates;
  bool is_default = false;
};

std::vector<RateCorner> every_corner() {
  std::vector<RateCorner> corners;
  const std::string can = SANDRUNNER_HARDWARE_EXAMPLES "/moteus.toml";
  const auto drives = [&](int rate_hz, std::uint64_t jitter_ticks) {
    const auto ticks = static_cast<std::uint64_t>(kControlHz / rate_hz);
    corners.push_back(
        {"drives " + std::to_string(rate_hz) + " Hz, jitter " + std::to_string(jitter_ticks),
         can,
         {"hardware.rate_hz=" + std::to_string(rate_hz)},
         {.joint_ticks = ticks, .imu_ticks = 8, .jitter_ticks = jitter_ticks, .attitude_ticks = 8},
         rate_hz == 1000 && jitter_ticks == 0});
  };
  for (const int rate_hz : {1000, 4000, 800, 500, 400}) {
    drives(rate_hz, 0);
    if (rate_hz < 4000) drives(rate_hz, 1);
  }
  const auto imu = [&](int rate_hz, int attitude_hz, std::uint64_t jitter_ticks) {
    corners.push_back({"IMU " + std::to_string(rate_hz) + ", attitude " +
                           std::to_string(attitude_hz) + " Hz, jitter " +
                           std::to_string(jitter_ticks),
                       can,
                       {"hardware.imu.rate_hz=" + std::to_string(rate_hz),
                        "hardware.imu.quaternion_rate_hz=" + std::to_string(attitude_hz)},
                       {.joint_ticks = 4,
                        .imu_ticks = static_cast<std::uint64_t>(kControlHz / rate_hz),
                        .jitter_ticks = jitter_ticks,
                        .attitude_ticks = static_cast<std::uint64_t>(kControlHz / attitude_hz)}});
  };
  imu(1000, 1000, 0);
  imu(1000, 100, 0);
  imu(200, 200, 1);
  imu(100, 100, 0);
  imu(100, 100, 1);
  corners.push_back({"Go2 over DDS, 500 Hz, jitter 0",
                     SANDRUNNER_UNITREE_EXAMPLE,
                     {},
                     {.joint_ticks = 8, .imu_ticks = 8, .attitude_ticks = 8}});
  corners.push_back({"Go2 over DDS, 500 Hz, jitter 1",
                     SANDRUNNER_UNITREE_EXAMPLE,
                     {},
                     {.joint_ticks = 8, .imu_ticks = 8, .jitter_ticks = 1, .attitude_ticks = 8}});
  // Samples may be lost, as long as none is older than the gate's limit.
  corners.push_back({"drives 1000 Hz, two of three lost",
                     can,
                     {},
                     {.joint_ticks = 12, .imu_ticks = 8, .attitude_ticks = 8}});
  corners.push_back({"drives 400 Hz, every second lost",
                     can,
                     {"hardware.rate_hz=400"},
                     {.joint_ticks = 20, .imu_ticks = 8, .attitude_ticks = 8}});
  corners.push_back({"IMU 100 Hz, every second lost",
                     can,
                     {"hardware.imu.rate_hz=100"},
                     {.joint_ticks = 4, .imu_ticks = 80, .attitude_ticks = 80}});
  return corners;
}

/// The robot of a corner, with the gate that the program would give it.
World world_at(const RateCorner& corner) {
  const std::string robot = corner.file == SANDRUNNER_UNITREE_EXAMPLE ? "go2" : "raibo";
  World world(robot, "rigid");
  ConfigTree tree;
  sim::add_terrain_layer(tree, "rigid");
  tree.add_file(corner.file);
  for (const std::string& setting : corner.settings) tree.set(setting);
  world.config = read_process_config(tree, &world.policy.spec());
  return world;
}

struct SensorCase {
  Fault fault;
  const char* what;
  Mode mode;
  double within_s;  ///< a generous limit at any rate
  std::function<void(AttackLoop&)> begin;
};

using Spoil = std::function<void(SensorFrame&, const SensorFrame& held, std::uint64_t n)>;

/// Spoils every frame from now on; `held` is the last good one.
std::function<void(AttackLoop&)> sensor(const Spoil& spoil) {
  return [spoil](AttackLoop& loop) {
    const SensorFrame held = loop.loop.record().input.sensors;
    const std::uint64_t begin = loop.loop.next_tick();
    loop.robot.spoil = [=](SensorFrame& fresh, std::uint64_t tick) {
      spoil(fresh, held, tick - begin);
    };
  };
}

std::vector<SensorCase> every_sensor_case() {
  using F = SensorFrame&;
  using H = const SensorFrame&;
  using N = std::uint64_t;
  const Mode walk = Mode::kWalk, stand = Mode::kStand;
  const auto held_joint = [](F f, H held, int j) {
    f.joints.position_rad[j] = held.joints.position_rad[j];
    f.joints.velocity_radps[j] = held.joints.velocity_radps[j];
  };
  return {
      {Fault::kNonFiniteJoint, "NaN", walk, 0.02,
       sensor([](F f, H, N) { f.joints.position_rad[4] = kNan; })},
      {Fault::kNonFiniteImu, "NaN", walk, 0.02,
       sensor([](F f, H, N) { f.imu.angular_velocity_radps[1] = kNan; })},
      {Fault::kJointsStale, "silent", walk, 0.02,
       sensor([](F f, H held, N) { f.joints = held.joints; })},
      {Fault::kImuStale, "silent", walk, 0.06, sensor([](F f, H held, N) { f.imu = held.imu; })},
      {Fault::kJointPosition, "0.4 rad past a stop", walk, 0.02,
       sensor([](F f, H, N) { f.joints.position_rad[2] = 0.4; })},
      {Fault::kJointSpeed, "70 rad/s", walk, 0.02,
       sensor([](F f, H, N) { f.joints.velocity_radps[1] = 70.0; })},
      {Fault::kJointTorque, "1.3 of the limit", walk, 0.02,
       sensor([](F f, H, N) { f.joints.torque_nm[7] = 83.0; })},
      {Fault::kTilt, "61 degrees", walk, 0.02, sensor([](F f, H, N) {
         f.imu.orientation_wxyz = turned(f.imu.orientation_wxyz, {1.0, 0.0, 0.0}, 1.2);
       })},
      {Fault::kDriveFault, "a code", walk, 0.02,
       sensor([](F f, H, N) { f.joints.drive_fault[11] = 1; })},
      {Fault::kEncoderJump, "0.45 rad", walk, 0.02,
       sensor([](F f, H, N) { f.joints.position_rad[0] += 0.45; })},
      {Fault::kEncoderFrozen, "one, in motion", walk, 1.5,
       sensor([held_joint](F f, H held, N) { held_joint(f, held, 1); })},
      {Fault::kEncoderFrozen, "one, but for a count", walk, 1.5, sensor([](F f, H held, N n) {
         f.joints.position_rad[1] = held.joints.position_rad[1] + (n / 7 % 2 == 0 ? 0.0 : 0.0004);
         f.joints.velocity_radps[1] = n % 2 == 0 ? 0.01 : -0.01;
       })},
      {Fault::kOverload, "1.9 of what it gives for ever", stand, 30.0, sensor([](F f, H, N n) {
         if (n % 160 < 150) f.joints.torque_nm[7] = n % 2 == 0 ? 52.0 : 52.1;
       })},
      {Fault::kFreeFall, "no weight", walk, 0.4, sensor([](F f, H, N n) {
         f.imu.linear_acceleration_mps2 = {0.5, 0.5, 0.1 + 1e-6 * static_cast<double>(n)};
       })},
      {Fault::kImuFrozen, "all of it", walk, 0.2, sensor([](F f, H held, N) {
         const std::uint64_t fresh = f.imu.tick;
         f.imu = held.imu;
         f.imu.tick = fresh;
       })},
      {Fault::kImuRange, "41 rad/s", walk, 0.02,
       sensor([](F f, H, N) { f.imu.angular_velocity_radps[1] = 41.0; })},
      {Fault::kImuAttitude, "accelerometer off by 46 degrees", walk, 3.0, sensor([](F f, H, N) {
         Vector3& felt = f.imu.linear_acceleration_mps2;
         felt = rotated(turned({1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.8), felt);
       })},
      {Fault::kImuGyro, "3 rad/s too much", walk, 0.5,
       sensor([](F f, H, N) { f.imu.angular_velocity_radps[2] += 3.0; })},
      {Fault::kImuGyro, "gyroscope reversed", walk, 3.0, sensor([](F f, H, N) {
         for (double& w : f.imu.angular_velocity_radps) w = -w;
       })},
      {Fault::kTorqueMissing, "0.3 of the limit too much", walk, 0.2,
       sensor([](F f, H, N) { f.joints.torque_nm[4] += 20.0; })},
      {Fault::kTorqueMissing, "a knee without torque", walk, 1.5,
       [](AttackLoop& loop) { loop.robot.limp = 1u << 5; }},
      {Fault::kSpeedMismatch, "2 rad/s too much", walk, 1.0,
       sensor([](F f, H, N) { f.joints.velocity_radps[1] += 2.0; })},
      {Fault::kSpeedMismatch, "a knee's speed reversed", walk, 3.0,
       sensor([](F f, H, N) { f.joints.velocity_radps[2] *= -1.0; })},
      {Fault::kSpeedMismatch, "a knee's speed stays 0", walk, 3.0,
       sensor([](F f, H, N) { f.joints.velocity_radps[2] = 0.0; })},
      {Fault::kForeignTraffic, "a frame", walk, 0.02,
       sensor([](F f, H, N) { f.foreign_traffic = 1u << 4; })},
  };
}

struct CornerResult {
  Fault found = Fault::kNone;
  double after_s = 0.0, tilt_deg = 0.0;
};

/// Runs until a fault or `within_s`.
CornerResult run_case(const World& world, const SampleRates& rates, const Snapshot& at,
                      const SensorCase& c) {
  AttackLoop loop(world, Drives::kGains, at);
  loop.robot.rates = rates;
  loop.command.velocity.vx_mps = 1.0;
  loop.run(0.05);
  c.begin(loop);
  CornerResult result;
  for (std::uint64_t n = 1; n <= ticks_from_s(c.within_s) && result.found == Fault::kNone; ++n) {
    loop.step();
    result.after_s = static_cast<double>(n) * kControlPeriod_s;
    if ((loop.output().faults & fault_bit(c.fault)) != 0) {
      result.found = c.fault;
    } else if (loop.fault() != Fault::kNone) {
      result.found = loop.fault();
    }
  }
  result.tilt_deg = degrees(tilt_rad(loop.truth()));
  return result;
}

/// The cases of one corner; what was not found, or found under a wrong name.
int run_corner(const RateCorner& corner, const std::vector<SensorCase>& cases) {
  const World world = world_at(corner);
  std::map<Mode, Snapshot> snapshots;
  {
    AttackLoop loop(world, Drives::kGains);
    loop.robot.rates = corner.rates;
    loop.stand_up();
    snapshots.emplace(Mode::kStand, loop.snapshot());
    loop.walk({.vx_mps = 1.0}, 4.0);
    snapshots.emplace(Mode::kWalk, loop.snapshot());
    loop.run(10.0);
    EXPECT_EQ(loop.fault(), Fault::kNone)
        << corner.name << ", control: " << fault_name(loop.fault());
    std::printf("| %s | control, 14 s of Walk | %s |\n", corner.name.c_str(),
                loop.fault() == Fault::kNone ? "no fault" : fault_name(loop.fault()));
    if (loop.fault() != Fault::kNone) return 1;
  }
  int missed = 0;
  for (const SensorCase& c : cases) {
    const CornerResult seen = run_case(world, corner.rates, snapshots.at(c.mode), c);
    std::printf("| %s | `%s`: %s | ", corner.name.c_str(), fault_name(c.fault), c.what);
    if (seen.found == c.fault) {
      std::printf("%.2f ms |\n", 1e3 * seen.after_s);
    } else if (seen.found != Fault::kNone) {
      std::printf("other: `%s` after %.2f ms |\n", fault_name(seen.found), 1e3 * seen.after_s);
    } else {
      ++missed;
      std::printf("**NOT detected** in %.2f s |\n", c.within_s);
    }
    EXPECT_NE(seen.found, Fault::kNone) << corner.name << ", " << fault_name(c.fault) << ", "
                                        << c.what << ": not detected in " << c.within_s << " s";
    std::fflush(stdout);
  }
  return missed;
}

TEST(SampleRatesTest, NoSpeedCheckIsOffWhereDrivesAnswerSeldom) {
  std::vector<SensorCase> cases;
  for (const SensorCase& c : every_sensor_case()) {
    if (c.fault == Fault::kSpeedMismatch) cases.push_back(c);
  }
  for (const RateCorner& corner : every_corner()) {
    if (corner.is_default || corner.name == "drives 400 Hz, jitter 0") run_corner(corner, cases);
  }
}

TEST(SampleRatesTest, CampaignOverEveryRowAndRate) {
  std::printf("| rate | row | detected within |\n|---|---|---|\n");
  for (const RateCorner& corner : every_corner()) {
    if (is_selected(corner.name)) run_corner(corner, every_sensor_case());
  }
}

/// One attitude that is lost is no frozen IMU.
TEST(SampleRatesTest, OneLostAttitudeIsNoFault) {
  for (const RateCorner& corner : every_corner()) {
    if (corner.rates.attitude_ticks <= corner.rates.imu_ticks) continue;
    const World world = world_at(corner);
    AttackLoop loop(world, Drives::kGains);
    loop.robot.rates = corner.rates;
    loop.stand_up();
    loop.robot.rates.attitude_ticks *= 2;
    loop.run(0.05);
    loop.robot.rates = corner.rates;
    loop.run(0.1);
    EXPECT_EQ(loop.fault(), Fault::kNone) << corner.name << ": " << fault_name(loop.fault());
  }
}

}  // namespace
}  // namespace sandrunner::attack
