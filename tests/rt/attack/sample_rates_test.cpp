// SPDX-License-Identifier: BSD-3-Clause
// Every fault that judges sensors, in every mode in which it is judged, with both kinds of drives,
// on three grounds, at the corners of every legal rate of drives and IMU: none is off, and a good
// robot has none.
#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "attack_loop.h"
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
World world_at(const RateCorner& corner, const std::string& terrain) {
  const std::string robot = corner.file == SANDRUNNER_UNITREE_EXAMPLE ? "go2" : "raibo";
  World world(robot, terrain);
  ConfigTree tree;
  sim::add_terrain_layer(tree, terrain);
  tree.add_file(corner.file);
  for (const std::string& setting : corner.settings) tree.set(setting);
  world.config = read_process_config(tree, &world.policy.spec());
  return world;
}

struct SensorCase {
  Fault fault;
  const char* what;
  ModeSet modes;    ///< in which the robot does what shows it; those of the fault table at most
  double within_s;  ///< a generous limit at any rate
  std::function<void(AttackLoop&)> begin;
};

/// Spoils every frame from now on.
std::function<void(AttackLoop&)> sensor(
    const std::function<void(SensorFrame&, const SensorFrame& held, std::uint64_t n)>& spoil) {
  return [spoil](AttackLoop& loop) { loop.robot.spoil = spoil; };
}

std::vector<SensorCase> every_sensor_case() {
  using F = SensorFrame&;
  using H = const SensorFrame&;
  using N = std::uint64_t;
  const ModeSet walk = kWalkOnly, stand = mode_set(Mode::kStand), all = kAlways;
  const auto held_joint = [](F f, H held, int j) {
    f.joints.position_rad[j] = held.joints.position_rad[j];
    f.joints.velocity_radps[j] = held.joints.velocity_radps[j];
  };
  return {
      {Fault::kNonFiniteJoint, "NaN", all, 0.02,
       sensor([](F f, H, N) { f.joints.position_rad[4] = kNan; })},
      {Fault::kNonFiniteImu, "NaN", all, 0.02,
       sensor([](F f, H, N) { f.imu.angular_velocity_radps[1] = kNan; })},
      {Fault::kJointsStale, "silent", all, 0.02,
       sensor([](F f, H held, N) { f.joints = held.joints; })},
      {Fault::kImuStale, "silent", all, 0.06, sensor([](F f, H held, N) { f.imu = held.imu; })},
      {Fault::kJointPosition, "0.4 rad past a stop", all, 0.02,
       sensor([](F f, H, N) { f.joints.position_rad[2] = 0.4; })},
      {Fault::kJointSpeed, "70 rad/s", all, 0.02,
       sensor([](F f, H, N) { f.joints.velocity_radps[1] = 70.0; })},
      {Fault::kJointTorque, "1.3 of the limit", all, 0.02,
       sensor([](F f, H, N) { f.joints.torque_nm[7] = 83.0; })},
      {Fault::kTilt, "61 degrees", all, 0.02, sensor([](F f, H, N) {
         f.imu.orientation_wxyz = turned(f.imu.orientation_wxyz, {1.0, 0.0, 0.0}, 1.2);
       })},
      {Fault::kDriveFault, "a code", all, 0.02,
       sensor([](F f, H, N) { f.joints.drive_fault[11] = 1; })},
      {Fault::kEncoderJump, "0.45 rad", all, 0.02,
       sensor([](F f, H, N) { f.joints.position_rad[0] += 0.45; })},
      {Fault::kEncoderFrozen, "one, in motion", walk, 1.5,
       sensor([held_joint](F f, H held, N) { held_joint(f, held, 1); })},
      {Fault::kEncoderFrozen, "one, but for a count", walk, 5.0, sensor([](F f, H held, N n) {
         f.joints.position_rad[1] = held.joints.position_rad[1] + (n / 7 % 2 == 0 ? 0.0 : 0.0004);
         f.joints.velocity_radps[1] = n % 2 == 0 ? 0.01 : -0.01;
       })},
      {Fault::kOverload, "1.9 of what it gives for ever", stand, 30.0, sensor([](F f, H, N n) {
         if (n % 160 < 150) f.joints.torque_nm[7] = n % 2 == 0 ? 52.0 : 52.1;
       })},
      {Fault::kFreeFall, "no weight", all, 0.4, sensor([](F f, H, N n) {
         f.imu.linear_acceleration_mps2 = {0.5, 0.5, 0.1 + 1e-6 * static_cast<double>(n)};
       })},
      {Fault::kImuFrozen, "all of it", all, 0.25, sensor([](F f, H held, N) {
         const std::uint64_t fresh = f.imu.tick;
         f.imu = held.imu;
         f.imu.tick = fresh;
       })},
      {Fault::kImuRange, "41 rad/s", all, 0.02,
       sensor([](F f, H, N) { f.imu.angular_velocity_radps[1] = 41.0; })},
      {Fault::kImuAttitude, "accelerometer off by 46 degrees", all, 3.0, sensor([](F f, H, N) {
         Vector3& felt = f.imu.linear_acceleration_mps2;
         felt = rotated(turned({1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.8), felt);
       })},
      {Fault::kImuGyro, "3 rad/s too much", all, 0.5,
       sensor([](F f, H, N) { f.imu.angular_velocity_radps[2] += 3.0; })},
      {Fault::kImuGyro, "gyroscope reversed", walk, 3.0, sensor([](F f, H, N) {
         for (double& w : f.imu.angular_velocity_radps) w = -w;
       })},
      {Fault::kTorqueMissing, "0.3 of the limit too much", all, 0.2,
       sensor([](F f, H, N) { f.joints.torque_nm[4] += 20.0; })},
      {Fault::kTorqueMissing, "a knee without torque", walk, 1.5,
       [](AttackLoop& loop) { loop.robot.limp = 1u << 5; }},
      {Fault::kSpeedMismatch, "2 rad/s too much", all, 1.0,
       sensor([](F f, H, N) { f.joints.velocity_radps[1] += 2.0; })},
      {Fault::kSpeedMismatch, "a knee's speed reversed", walk, 3.0,
       sensor([](F f, H, N) { f.joints.velocity_radps[2] *= -1.0; })},
      {Fault::kSpeedMismatch, "a knee's speed stays 0", walk, 3.0,
       sensor([](F f, H, N) { f.joints.velocity_radps[2] = 0.0; })},
      {Fault::kForeignTraffic, "a frame", all, 0.02,
       sensor([](F f, H, N) { f.foreign_traffic = 1u << 4; })},
  };
}

struct CornerResult {
  Fault found = Fault::kNone;
  double after_s = 0.0, tilt_deg = 0.0;
};

/// Runs until a fault or `within_s`.
CornerResult run_case(const World& world, Drives drives, const SampleRates& rates,
                      const Snapshot& at, const SensorCase& c) {
  AttackLoop loop(world, drives, at);
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

struct Corner {
  RateCorner at;
  std::string terrain = "rigid";
  Drives drives = Drives::kGains;

  std::string name() const {
    return at.name + ", " + terrain + (drives == Drives::kGains ? ", gains" : ", torques");
  }
};

/// The robot in every mode that judges, or none if a good robot has a fault on the way.
std::map<Mode, Snapshot> snapshots_of(const Corner& corner, const World& world) {
  std::map<Mode, Snapshot> snapshots;
  AttackLoop loop(world, corner.drives);
  loop.robot.rates = corner.at.rates;
  const auto keep = [&](Mode mode) {
    EXPECT_EQ(loop.mode(), mode) << corner.name();
    snapshots.emplace(mode, loop.snapshot());
  };
  loop.command.velocity.vx_mps = 1.0;
  walk_through_modes(loop, 2.5, 4.0, keep);
  loop.run(10.0);
  const bool sound = loop.fault() == Fault::kNone;
  EXPECT_TRUE(sound) << corner.name() << ", control: " << fault_name(loop.fault());
  std::printf("| %s | control, 14 s of Walk | %s |\n", corner.name().c_str(),
              sound ? "no fault" : fault_name(loop.fault()));
  if (!sound) snapshots.clear();
  return snapshots;
}

struct Tally {
  int runs = 0, other = 0, missed = 0;
};

/// The cases of one corner, each in its modes.
void run_corner(const Corner& corner, const std::vector<SensorCase>& cases, Tally& tally) {
  const World world = world_at(corner.at, corner.terrain);
  const std::map<Mode, Snapshot> snapshots = snapshots_of(corner, world);
  for (const SensorCase& c : cases) {
    const FaultRow& row = kFaultTable[std::countr_zero(fault_bit(c.fault))];
    for (const auto& [mode, at] : snapshots) {
      if ((row.modes & c.modes & mode_set(mode)) == 0) continue;
      const CornerResult seen = run_case(world, corner.drives, corner.at.rates, at, c);
      ++tally.runs;
      tally.other += seen.found != Fault::kNone && seen.found != c.fault;
      tally.missed += seen.found == Fault::kNone;
      if (seen.found != c.fault || seen.after_s > 0.1) {
        std::printf("| %s | `%s`: %s, in %s | %s after %.2f ms |\n", corner.name().c_str(),
                    row.name, c.what, mode_name(mode),
                    seen.found == Fault::kNone ? "**nothing**" : fault_name(seen.found),
                    1e3 * seen.after_s);
        std::fflush(stdout);
      }
      EXPECT_NE(seen.found, Fault::kNone) << corner.name() << ", " << row.name << ", " << c.what
                                          << ", in " << mode_name(mode) << ": not detected";
    }
  }
}

TEST(SampleRatesTest, NoSpeedCheckIsOffWhereDrivesAnswerSeldom) {
  std::vector<SensorCase> cases;
  for (const SensorCase& c : every_sensor_case()) {
    if (c.fault == Fault::kSpeedMismatch) cases.push_back(c);
  }
  Tally tally;
  for (const RateCorner& at : every_corner()) {
    if (at.is_default || at.name == "drives 400 Hz, jitter 0") run_corner({at}, cases, tally);
  }
}

TEST(SampleRatesTest, CampaignOverEveryRowModeDriveRateAndGround) {
  std::printf("| corner | row | detected |\n|---|---|---|\n");
  Tally tally;
  for (const RateCorner& at : every_corner()) {
    for (const char* terrain : {"rigid", "dry-sand", "grass"}) {
      for (const Drives drives : {Drives::kGains, Drives::kTorque}) {
        const Corner corner{at, terrain, drives};
        if (is_selected(corner.name())) run_corner(corner, every_sensor_case(), tally);
      }
    }
  }
  std::printf("%d runs, %d found under another name, %d not found\n", tally.runs, tally.other,
              tally.missed);
}

/// One attitude that is lost is no frozen IMU.
TEST(SampleRatesTest, OneLostAttitudeIsNoFault) {
  for (const RateCorner& corner : every_corner()) {
    if (corner.rates.attitude_ticks <= corner.rates.imu_ticks) continue;
    const World world = world_at(corner, "rigid");
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
