// SPDX-License-Identifier: BSD-3-Clause
// Sound robots whose drives report torque in another scale or filter what they report: random
// commands at the corners of the envelope, pushes, every ground. No fault but of a robot that
// falls.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "attack_loop.h"

namespace sandrunner::attack {
namespace {

using MakeSpoil = std::function<decltype(FaultyRobot::spoil)()>;

/// Low-pass of first order of a joint's speed or torque.
MakeSpoil low_pass(JointArray<double> JointState::* values, double time_s) {
  return [=] {
    return [=, low = JointArray<double>{}](SensorFrame& fresh, auto&&...) mutable {
      for (int j = 0; j < kNumJoints; ++j) {
        low[j] += kControlPeriod_s / time_s * ((fresh.joints.*values)[j] - low[j]);
      }
      fresh.joints.*values = low;
    };
  };
}
/// `known` is what hardware.drive[].reported_torque says.
MakeSpoil torque_times(double scale, double known = 1.0) {
  return [=] {
    return [=](SensorFrame& fresh, auto&&...) {
      for (double& nm : fresh.joints.torque_nm) nm *= scale / known;
    };
  };
}

/// Changes the IMU alone; `t_s` counts from the start of the walk.
MakeSpoil imu(const std::function<void(ImuSample&, double t_s)>& change) {
  return [=] {
    return [=, n = 0.0](SensorFrame& fresh, auto&&...) mutable {
      change(fresh.imu, n * kControlPeriod_s);
      n += 1.0;
    };
  };
}
/// The attitude of `ticks` ago, with the least of noise: no attitude is to stay the same.
MakeSpoil late_attitude(std::size_t ticks) {
  return [=] {
    return [=, past = std::vector<Rotation>()](SensorFrame& fresh, auto&&...) mutable {
      past.push_back(fresh.imu.orientation_wxyz);
      fresh.imu.orientation_wxyz = past[past.size() - 1 - std::min(ticks, past.size() - 1)];
      fresh.imu.orientation_wxyz[3] += past.size() % 2 == 0 ? 1e-9 : -1e-9;
    };
  };
}
/// Speeds in steps of `step_radps`.
MakeSpoil coarse_speed(double step_radps) {
  return [=] {
    return [=](SensorFrame& fresh, auto&&...) {
      for (double& v : fresh.joints.velocity_radps) v = step_radps * std::round(v / step_radps);
    };
  };
}

struct SensorModel {
  std::string name;
  MakeSpoil spoil;
};
std::vector<SensorModel> every_model() {
  constexpr Vector3 kForward{1.0, 0.0, 0.0}, kUp{0.0, 0.0, 1.0};
  std::vector<SensorModel> models = {
      {"ideal", nullptr},
      {"gyro bias 0.05 rad/s", imu([](ImuSample& sample, double) {
         for (double& w : sample.angular_velocity_radps) w += 0.05;
       })},
      {"yaw drifts by 0.1 rad/s", imu([=](ImuSample& sample, double t_s) {
         sample.orientation_wxyz =
             product(turned({1.0, 0.0, 0.0, 0.0}, kUp, 0.1 * t_s), sample.orientation_wxyz);
       })},
      {"attitude rolls by 3 degrees in 20 s and back", imu([=](ImuSample& sample, double t_s) {
         sample.orientation_wxyz =
             turned(sample.orientation_wxyz, kForward, 0.0524 * std::sin(0.314 * t_s));
       })},
      {"attitude 40 ms late", late_attitude(160)},
      {"speed in steps of 0.2 rad/s", coarse_speed(0.2)},
  };
  for (const int ms : {5, 10, 20}) {
    models.push_back({"speed low-pass " + std::to_string(ms) + " ms",
                      low_pass(&JointState::velocity_radps, 1e-3 * ms)});
  }
  for (const int ms : {5, 20}) {
    models.push_back({"torque low-pass " + std::to_string(ms) + " ms",
                      low_pass(&JointState::torque_nm, 1e-3 * ms)});
  }
  for (const int percent : {60, 70, 75, 80, 85, 120, 125, 130}) {
    const std::string name = "torque x " + std::to_string(percent) + " %";
    models.push_back({name, torque_times(0.01 * percent)});
    // check --nudge finds it within a twentieth.
    models.push_back(
        {name + ", known but for 5 %", torque_times(0.01 * percent, 0.0105 * percent)});
  }
  return models;
}

const std::vector<std::string> kGrounds = {"dry-sand",    "rigid",       "grass",
                                           "wet-sand",    "vinyl",       "athletic-track",
                                           "memory-foam", "air-mattress"};

/// Stands up after 3 s, then a walk: a new corner of the envelope every 2.5 s, a push every 5 s.
Outcome random_walk(const World& world, std::uint64_t seed, const MakeSpoil& spoil,
                    double duration_s) {
  AttackLoop loop(world, Drives::kGains);
  if (spoil) loop.robot.spoil = spoil();
  loop.run(3.0);
  loop.stand_up();
  const CommandEnvelope& most = world.config.controller.shaping.envelope;
  sim::Draw draw(seed);
  const auto corner = [&](double low, double high) {
    const double u = draw(0.0, 3.0);
    return u < 1.0 ? low : u < 2.0 ? 0.0 : high;
  };
  constexpr std::uint64_t kCommand_ticks = 5 * kControlHz / 2, kPush_ticks = 5 * kControlHz;
  std::uint64_t n = 0;
  loop.hand = [&](sim::SimulatorState& state) {
    if (n % kCommand_ticks == 0) {
      loop.command.velocity = {corner(-most.backward_mps, most.forward_mps),
                               corner(-most.lateral_mps, most.lateral_mps),
                               corner(-most.yaw_radps, most.yaw_radps)};
    }
    if (++n % kPush_ticks == 0) {
      state.robot.rigid.velocity =
          state.robot.rigid.velocity + sim::Vec3<double>{draw(-0.5, 0.5), draw(-0.5, 0.5), 0.0};
    }
  };
  loop.ask(ModeRequest::kWalk);
  return watch(loop, duration_s);
}

struct ModelTally {
  int runs = 0, fell = 0, faults_without_fall = 0;
  std::map<std::string, int> faults;

  void add(const Outcome& seen) {
    ++runs;
    const bool in_a_fall = seen.fault == Fault::kTilt || degrees(seen.tilt_rad) > 45.0;
    if (seen.fault != Fault::kNone && !in_a_fall) {
      ++faults_without_fall;
      ++faults[fault_name(seen.fault)];
    } else if (seen.fell()) {
      ++fell;
    }
  }
};

ModelTally over_grounds(const SensorModel& model, std::size_t grounds, double duration_s) {
  ModelTally tally;
  for (std::size_t g = 0; g < grounds; ++g) {
    const World world("raibo", kGrounds[g]);
    tally.add(random_walk(world, g + 1, model.spoil, duration_s));
  }
  std::printf("| %s | %d | **%d** | %d |", model.name.c_str(), tally.runs,
              tally.faults_without_fall, tally.fell);
  for (const auto& [fault, count] : tally.faults) std::printf(" %s %d", fault.c_str(), count);
  std::printf(" |\n");
  std::fflush(stdout);
  return tally;
}

TEST(SensorModelTest, IdealSensorsAndSlowSpeedsGiveNoFalseAlarm) {
  for (const SensorModel& model : every_model()) {
    if (model.name != "ideal" && model.name != "speed low-pass 10 ms") continue;
    EXPECT_EQ(over_grounds(model, 2, 10.0).faults_without_fall, 0) << model.name;
  }
}

TEST(SensorModelTest, CampaignOverModelsAndGrounds) {
  std::printf(
      "| sensors | runs | faults without a fall | falls | faults |\n|---|---|---|---|---|\n");
  for (const SensorModel& model : every_model()) {
    if (!is_selected(model.name)) continue;
    const ModelTally tally = over_grounds(model, kGrounds.size(), 25.0);
    EXPECT_EQ(tally.faults_without_fall, 0) << model.name;
  }
}

}  // namespace
}  // namespace sandrunner::attack
