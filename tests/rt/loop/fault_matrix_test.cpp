// SPDX-License-Identifier: BSD-3-Clause
// Every fault in every mode in which it is judged, with drives that evaluate the gains and with
// drives that take a torque: how long until the robot only brakes, and how hard it moves after.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <string>

#include "rt/core/joint_pd.h"
#include "rt/loop/control_loop.h"
#include "tests/rt/support.h"
#include "tests/sim/support.h"

namespace sandrunner {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

enum class Drives { kGains, kTorque };

/// The simulated robot, with a fault in its sensors or without.
class FaultyRobot final : public RobotIo {
 public:
  FaultyRobot(sim::Simulator& simulator, Drives drives) : simulator_(simulator), drives_(drives) {}

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override {
    simulator_.read(tick, frame);
    if (spoil) {
      spoil(frame, good_, since_++);
    } else {
      good_ = frame;
    }
    seen_ = frame;
  }
  void write(const SafeCommand& command) noexcept override {
    last = command;
    if (weak) return simulator_.write(sim::pass_gate(JointCommand{}));
    simulator_.write(drives_ == Drives::kGains || !command.enabled() ? command : as_torque());
  }
  void skip(std::uint64_t ticks, const SafeCommand& held) noexcept override {
    simulator_.skip(ticks, held);
  }
  void cut_drives() noexcept override { simulator_.cut_drives(); }
  void shut_down() noexcept override {}

  /// What happens to each frame; `good` is the last one before, `n` counts from 0.
  std::function<void(SensorFrame& frame, const SensorFrame& good, std::uint64_t n)> spoil;
  SafeCommand last;
  bool weak = false;  ///< the drives give no torque

 private:
  // What the driver of torque drives does: it evaluates the law on what it has read, and gives no
  // torque where that is not to be trusted.
  SafeCommand as_torque() const {
    const JointCommand& c = last.joints();
    JointCommand torque;
    for (int j = 0; j < kNumJoints; ++j) {
      const double nm = joint_torque(seen_.joints.position_rad[j], seen_.joints.velocity_radps[j],
                                     c.position_rad[j], c.velocity_radps[j], c.kp_nmprad[j],
                                     c.kd_nmsprad[j], c.feedforward_nm[j]);
      const bool blind = (last.blind_joints() >> j & 1) != 0;
      torque.feedforward_nm[j] = blind ? 0.0 : nm;
    }
    return sim::pass_gate(torque);
  }

  sim::Simulator& simulator_;
  Drives drives_;
  SensorFrame good_, seen_;
  std::uint64_t since_ = 0;
};

/// The policy, with a fault or without.
class FaultyPolicy final : public PolicyLink {
 public:
  explicit FaultyPolicy(Policy& policy) : policy_(&policy) {}
  const PolicyOutput& newest() noexcept override { return newest_; }
  void release(const PolicyInput& input) noexcept override {
    if (hangs) return;
    policy_.release(input);
    const JointArray<double> before_rad = newest_.target_rad;
    newest_ = policy_.newest();
    if (spoil) spoil(newest_, before_rad);
  }
  InlinePolicy& policy() { return policy_; }
  void restore(const PolicyOutput& newest) { newest_ = newest; }

  bool hangs = false;
  std::function<void(PolicyOutput& answer, const JointArray<double>& before_rad)> spoil;

 private:
  InlinePolicy policy_;
  PolicyOutput newest_;
};

/// The robot in one mode, ready to be copied.
struct Snapshot {
  std::uint64_t tick;
  sim::SimulatorState robot;
  ControllerState controller;
  PolicyOutput answer;
  NetworkState network;
};

class FaultMatrixTest : public testing::Test {
 protected:
  static constexpr Mode kModes[] = {Mode::kPassive, Mode::kDamping, Mode::kStandUp,
                                    Mode::kStand,   Mode::kWalk,    Mode::kFault};

  FaultMatrixTest() : policy(load_shipped_policy()) {
    config = config_of("dry-sand", {}, &policy.spec());
    sim::Simulator simulator(config.robot, config.simulator);
    simulator.reset_lying();
    FaultyRobot robot(simulator, Drives::kGains);
    FaultyPolicy link(policy);
    ManualClock clock;
    ControlLoop loop(robot, config.controller, Mode::kPassive, link, clock);
    TickRecord record;
    OperatorCommand command;
    const auto ask = [&](ModeRequest request) {
      command.request = request;
      ++command.request_id;
    };
    std::uint64_t tick = 0;
    const auto run = [&](double duration_s) {
      for (std::uint64_t end = tick + ticks_from_s(duration_s); tick < end; ++tick) {
        command.tick = tick;
        loop.tick({.number = tick}, command, record);
      }
    };
    const auto keep = [&](Mode mode) {
      ASSERT_EQ(record.output.mode, mode);
      snapshots[mode] = {tick, simulator.state(), loop.controller().state(), link.newest(),
                         policy.state()};
    };
    run(0.1);
    keep(Mode::kPassive);
    ask(ModeRequest::kArm);
    run(0.1);
    keep(Mode::kDamping);
    ask(ModeRequest::kStand);
    run(1.5);
    keep(Mode::kStandUp);
    run(2.0);
    keep(Mode::kStand);
    ask(ModeRequest::kWalk);
    command.velocity.vx_mps = 0.5;
    run(2.0);
    keep(Mode::kWalk);
    robot.spoil = [](SensorFrame& frame, const SensorFrame&, std::uint64_t) {
      frame.joints.drive_fault[0] = 1;
    };
    run(0.1);
    keep(Mode::kFault);
  }

  Policy policy;
  ProcessConfig config;
  std::map<Mode, Snapshot> snapshots;
};

/// What a case may spoil.
struct Plant {
  FaultyRobot& robot;
  FaultyPolicy& policy;
  OperatorCommand& command;
  std::uint64_t& tick;  ///< of the tick to come
};

struct FaultCase {
  Fault fault;
  std::uint64_t within_ticks;  ///< from the first disturbed tick to the one that brakes
  std::function<void(Plant&)> begin;
  std::function<void(Plant&)> each_tick = nullptr;  ///< before it
};

std::vector<FaultCase> cases() {
  const auto sensor = [](Fault fault, std::uint64_t within_ticks, auto spoil) {
    return FaultCase{fault, within_ticks, [spoil](Plant& p) { p.robot.spoil = spoil; }};
  };
  using F = SensorFrame&;
  using G = const SensorFrame&;
  using N = std::uint64_t;
  const double half_rad = 0.5 * 61.0 * 3.14159265358979 / 180.0;
  const std::array<double, 4> on_its_side = {std::cos(half_rad), std::sin(half_rad), 0.0, 0.0};
  return {
      sensor(Fault::kNonFiniteJoint, 1, [](F f, G, N) { f.joints.position_rad[4] = kNan; }),
      sensor(Fault::kNonFiniteImu, 1, [](F f, G, N) { f.imu.orientation_wxyz[1] = kNan; }),
      {Fault::kNonFiniteAction, 42,
       [](Plant& p) { p.policy.spoil = [](PolicyOutput& o, auto&) { o.target_rad[3] = kNan; }; }},
      {Fault::kNonFiniteCommand, 1, [](Plant& p) { p.command.velocity.vy_mps = kNan; }},
      sensor(Fault::kJointsStale, 9, [](F f, G g, N) { f.joints = g.joints; }),
      sensor(Fault::kImuStale, 41, [](F f, G g, N) { f.imu = g.imu; }),
      {Fault::kPolicyStale, 122, [](Plant& p) { p.policy.hangs = true; }},
      // Slowly, as an encoder that jumps is another fault.
      sensor(Fault::kJointPosition, 40,
             [](F f, G, N n) { f.joints.position_rad[2] += 0.08 * static_cast<double>(n); }),
      sensor(Fault::kJointSpeed, 1, [](F f, G, N) { f.joints.velocity_radps[1] = -60.1; }),
      sensor(Fault::kJointTorque, 20, [](F f, G, N) { f.joints.torque_nm[7] = 76.2; }),
      sensor(Fault::kTilt, 1, [on_its_side](F f, G, N) { f.imu.orientation_wxyz = on_its_side; }),
      sensor(Fault::kDriveFault, 1, [](F f, G, N) { f.joints.drive_fault[11] = 7; }),
      sensor(Fault::kEmergencyStop, 1, [](F f, G, N) { f.emergency_stop = 1; }),
      {Fault::kDrivesCut, 1, [](Plant& p) { p.robot.cut_drives(); }},
      {Fault::kTime, 1, [](Plant&) {}, [](Plant& p) { --p.tick; }},
      {Fault::kLoopStalled, 1, [](Plant& p) { p.tick += 121; }},
      sensor(Fault::kEncoderJump, 1, [](F f, G, N) { f.joints.position_rad[0] += 0.3; }),
      sensor(Fault::kEncoderFrozen, 4000,
             [](F f, G g, N) {
               const JointArray<std::uint64_t> fresh = f.joints.tick;
               f.joints = g.joints;
               f.joints.tick = fresh;
             }),
      {Fault::kPolicyFrozen, 900,
       [](Plant& p) {
         p.policy.spoil = [](PolicyOutput& o, const auto& before) { o.target_rad = before; };
       }},
      sensor(Fault::kOverload, 40000, [](F f, G, N) { f.joints.torque_nm[7] = 60.0; }),
      sensor(Fault::kFreeFall, 1000,
             [](F f, G, N) {
               f.imu.linear_acceleration_mps2 = {0.5, 0.5, -0.5};
             }),
      {Fault::kNotStanding, 12000, [](Plant& p) { p.robot.weak = true; }},
  };
}

TEST_F(FaultMatrixTest, EveryFaultInEveryModeOnlyBrakesInTimeAndStaysHarmless) {
  double worst_torque_nm = 0.0, worst_speed_radps = 0.0;
  int runs = 0;
  const double limit_nm = config.robot.model.torque_limit_nm[0];
  for (const FaultCase& c : cases()) {
    const FaultRow& row = kFaultTable[std::countr_zero(static_cast<std::uint64_t>(c.fault))];
    std::uint64_t slowest_ticks = 0;
    double torque_nm = 0.0, speed_radps = 0.0;
    for (const Mode mode : kModes) {
      if ((row.modes & mode_set(mode)) == 0) continue;
      for (const Drives drives : {Drives::kGains, Drives::kTorque}) {
        SCOPED_TRACE(std::string(row.name) + " in " + mode_name(mode) +
                     (drives == Drives::kGains ? ", gains" : ", torque"));
        const Snapshot& at = snapshots.at(mode);
        sim::Simulator simulator(config.robot, config.simulator);
        simulator.restore(at.robot);
        FaultyRobot robot(simulator, drives);
        policy.set_state(at.network);
        FaultyPolicy link(policy);
        link.policy().restore(at.answer, at.network);
        link.restore(at.answer);
        ManualClock clock;
        ControlLoop loop(robot, config.controller, Mode::kPassive, link, clock);
        loop.restore(at.controller);
        OperatorCommand command;
        command.request_id = at.controller.request_id;
        command.velocity.vx_mps = 0.5;
        std::uint64_t tick = at.tick;
        TickRecord record;
        Plant plant{robot, link, command, tick};
        const auto step = [&] {
          command.tick = tick;
          loop.tick({.number = tick++}, command, record);
        };
        step();  // the last good one
        c.begin(plant);
        const auto bit = static_cast<std::uint64_t>(c.fault);
        std::uint64_t ticks = 0;
        do {
          if (c.each_tick) c.each_tick(plant);
          step();
          ++ticks;
        } while ((record.output.faults & bit) == 0 && ticks < c.within_ticks);
        ASSERT_NE(record.output.faults & bit, 0u) << "not noticed in " << ticks << " ticks";
        ASSERT_EQ(record.output.mode, Mode::kFault);
        if (mode != Mode::kFault) {
          EXPECT_EQ(record.output.first_fault, c.fault);
        }
        slowest_ticks = std::max(slowest_ticks, ticks);
        RobotTruth truth;
        for (int n = 0; n < 1000; ++n) {  // a quarter of a second
          for (int j = 0; j < kNumJoints; ++j) {
            ASSERT_EQ(robot.last.joints().kp_nmprad[j], 0.0);
            ASSERT_EQ(robot.last.joints().feedforward_nm[j], 0.0);
            ASSERT_EQ(robot.last.joints().velocity_radps[j], 0.0);
          }
          ASSERT_TRUE(robot.truth(truth) || simulator.truth(truth));
          for (int j = 0; j < kNumJoints; ++j) {
            torque_nm = std::max(torque_nm, std::fabs(truth.joint_torque_nm[j]));
            speed_radps = std::max(speed_radps, std::fabs(truth.joint_velocity_radps[j]));
          }
          step();
        }
        ASSERT_LE(torque_nm, limit_nm);
        ++runs;
      }
    }
    std::printf("%-18s %6.2f ms to damping, then at most %5.1f N m, %5.1f rad/s\n", row.name,
                0.25 * static_cast<double>(slowest_ticks), torque_nm, speed_radps);
    worst_torque_nm = std::max(worst_torque_nm, torque_nm);
    worst_speed_radps = std::max(worst_speed_radps, speed_radps);
  }
  std::printf("%d runs: at most %.1f N m, %.1f rad/s\n", runs, worst_torque_nm, worst_speed_radps);
  EXPECT_LT(worst_speed_radps, 30.0);
}

TEST_F(FaultMatrixTest, EveryFaultOfTheTableHasACase) {
  std::uint64_t covered = static_cast<std::uint64_t>(Fault::kNonFiniteOutput);  // faults_test.cpp
  for (const FaultCase& c : cases()) covered |= static_cast<std::uint64_t>(c.fault);
  EXPECT_EQ(covered, (std::uint64_t{1} << kNumFaults) - 1);
}

}  // namespace
}  // namespace sandrunner
