// SPDX-License-Identifier: BSD-3-Clause
// After a cut of the supply one joint is off by a turn of its motor. On the way to the lying pose,
// its wrong reading passes the lying value. The robot is not armed.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "attack_loop.h"
#include "sim/robot/clearance.h"

namespace sandrunner::attack {
namespace {

/// Where the leg is released.
enum class Release {
  kFolded,  ///< in the lying pose, after the joint has passed the place where it reads that pose
  kThere,   ///< in that place: the drives' values cannot tell it from the lying pose
};

struct Attempt {
  bool armed = false, stood = false;
  Outcome after;  ///< of Stand
};

class SupplyCut {
 public:
  explicit SupplyCut(const World& world) : world_(world), at_(standing(world, Drives::kGains)) {}

  /// Cuts the supply for 3 s. Joint `joint` comes back off by `offset_rad`, or by nothing if it is
  /// `sound`. The legs are then moved alike in both cases, and the robot is armed.
  Attempt run(int joint, double offset_rad, bool sound, Release release) {
    AttackLoop loop(world_, Drives::kGains, at_);
    loop.robot.limp = kAllJoints;
    bool silent = true;
    loop.step();
    const JointState last = loop.record.input.sensors.joints;
    loop.robot.spoil = [&](SensorFrame& fresh, auto&&...) {
      if (silent) {
        fresh.joints = last;
      } else if (!sound) {
        fresh.joints.position_rad[joint] += offset_rad;
      }
    };
    loop.run(3.0);
    silent = false;
    loop.robot.limp = 0;
    if (!sound) loop.robot.drive_is_misled = std::uint64_t{1} << joint;
    loop.run(0.5);
    const JointArray<double>& lying_rad = world_.config.robot.lying_rad;
    JointArray<double> target_rad = lying_rad;
    target_rad[joint] -= offset_rad;
    move(loop, loop.simulator.state().robot.rigid.q, kLifted_m, 1.0);
    move(loop, target_rad, kLifted_m, 1.5);
    const JointArray<double>& released_rad = release == Release::kFolded ? lying_rad : target_rad;
    move(loop, released_rad, kLifted_m, 1.0);
    move(loop, released_rad, lowered_m(released_rad), 1.0);
    loop.run(1.0);

    loop.ask(ModeRequest::kResetFault);
    loop.run(0.1);
    loop.ask(ModeRequest::kArm);
    loop.run(0.1);
    Attempt attempt;
    attempt.armed = loop.mode() == Mode::kDamping;
    attempt.after.fault = loop.fault();
    if (!attempt.armed) return attempt;
    loop.ask(ModeRequest::kStand);
    attempt.after = watch(loop, 6.0);
    attempt.stood = loop.mode() == Mode::kStand && !attempt.after.fell();
    return attempt;
  }

 private:
  /// Moves body and joints by hand in `duration_s`, no faster at the ends than in between.
  static void move(AttackLoop& loop, const JointArray<double>& to_rad, double height_m,
                   double duration_s) {
    const sim::RigidState<double> from = loop.simulator.state().robot.rigid;
    const Vector3 up = rotated(
        inverse({from.orientation.w, from.orientation.x, from.orientation.y, from.orientation.z}),
        {0.0, 0.0, 1.0});
    // Back to level, about the horizontal axis that is shortest.
    const double tilt = std::acos(std::clamp(up[2], -1.0, 1.0));
    const double sine = std::max(std::hypot(up[0], up[1]), 1e-9);
    const sim::Vec3<double> level{-tilt * up[1] / sine, tilt * up[0] / sine, 0.0};
    const double ticks = duration_s * kControlHz;
    double n = 0.0;
    loop.hand = [&](sim::SimulatorState& state) {
      n += 1.0;
      const double u = std::min(n / ticks, 1.0);
      const double way = u * u * (3.0 - 2.0 * u), rate = 6.0 * u * (1.0 - u) / duration_s;
      sim::RigidState<double>& x = state.robot.rigid;
      for (int j = 0; j < kNumJoints; ++j) {
        x.q[j] = from.q[j] + (to_rad[j] - from.q[j]) * way;
        x.qd[j] = (to_rad[j] - from.q[j]) * rate;
      }
      x.position = from.position;
      x.position.z += (height_m - from.position.z) * way;
      x.velocity = {0.0, 0.0, (height_m - from.position.z) * rate};
      x.orientation = sim::integrate(from.orientation, way * level);
      x.angular_velocity = rate * level;
    };
    loop.run(duration_s);
    loop.hand = nullptr;
  }

  /// Height of the base 2 mm above the ground.
  double lowered_m(const JointArray<double>& q_rad) const {
    const auto flat = [](double, double) { return 0.0; };
    return 0.002 - sim::lowest_clearance(world_.config.robot.model, q_rad, flat);
  }

  static constexpr double kLifted_m = 0.8;
  const World& world_;
  Snapshot at_;
};

struct ArmTally {
  int runs = 0, armed = 0, stood = 0, toppled = 0;
  std::map<std::string, int> refused, later;
  double tilt_deg = 0.0, torque_nm = 0.0;

  void add(const Attempt& attempt) {
    ++runs;
    if (attempt.armed) ++armed;
    if (attempt.stood) ++stood;
    if (attempt.after.fell()) ++toppled;
    const Fault fault = attempt.after.fault;
    if (fault != Fault::kNone) ++(attempt.armed ? later : refused)[fault_name(fault)];
    tilt_deg = std::max(tilt_deg, degrees(attempt.after.largest_tilt_rad));
    torque_nm = std::max(torque_nm, attempt.after.torque_nm);
  }
  void print(const std::string& name) const {
    std::printf("| %s | %d | **%d** | %d | **%d** | %.0f | %.0f N m |", name.c_str(), runs, armed,
                stood, toppled, tilt_deg, torque_nm);
    for (const auto& [fault, count] : refused) std::printf(" %s %d", fault.c_str(), count);
    std::printf(" |");
    for (const auto& [fault, count] : later) std::printf(" %s %d", fault.c_str(), count);
    std::printf(" |\n");
    std::fflush(stdout);
  }
};

/// 64 pairs: HAA and HFE of each leg, four gears, two directions. Of the right hind leg alone: 16.
ArmTally over_pairs(SupplyCut& cut, bool sound, Release release, bool one_leg = false) {
  ArmTally tally;
  for (int joint = one_leg ? 9 : 0; joint < kNumJoints; ++joint) {
    if (joint % kJointsPerLeg == 2) continue;
    for (const double gear : {6.0, 6.75, 8.0, 10.0}) {
      for (const double direction : {-1.0, 1.0}) {
        const double offset_rad = direction * 2.0 * std::numbers::pi / gear;
        tally.add(cut.run(joint, offset_rad, sound, release));
      }
    }
  }
  return tally;
}

TEST(MisplacedJointTest, PassingTheLyingValueDoesNotEndTheDoubtAboutAJoint) {
  const World world("raibo", "rigid");
  SupplyCut cut(world);
  for (const int joint : {0, 1, 10}) {
    const double offset_rad = 2.0 * std::numbers::pi / 6.75;
    const Attempt control = cut.run(joint, offset_rad, true, Release::kFolded);
    EXPECT_TRUE(control.armed && control.stood) << "control, joint " << joint;
    const Attempt wrong = cut.run(joint, offset_rad, false, Release::kFolded);
    EXPECT_FALSE(wrong.armed) << "joint " << joint << " then tilted by "
                              << degrees(wrong.after.largest_tilt_rad) << " degrees";
    if (!wrong.armed) {
      EXPECT_EQ(wrong.after.fault, Fault::kJointMisplaced);
    }
  }
}

TEST(MisplacedJointTest, CampaignOverJointsGearsAndDirections) {
  std::printf(
      "| runs | of | armed | stand | topple | largest tilt | torque | refused by | "
      "fault in Stand |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string robot : {"raibo", "go2"}) {
    if (!is_selected(robot)) continue;
    const World world(robot, "rigid");
    SupplyCut cut(world);
    const ArmTally control = over_pairs(cut, true, Release::kFolded);
    control.print(robot + ", folded, control");
    const ArmTally folded = over_pairs(cut, false, Release::kFolded);
    folded.print(robot + ", folded, a motor turn off");
    const ArmTally there = over_pairs(cut, false, Release::kThere, true);
    there.print(robot + ", let go on the way, a motor turn off");
    EXPECT_EQ(control.stood, control.runs) << robot;
    EXPECT_EQ(folded.armed, 0) << robot;
  }
}

}  // namespace
}  // namespace sandrunner::attack
