// SPDX-License-Identifier: BSD-3-Clause
// Whether joints and drives can be believed: their encoders change as their speeds and the body's
// motion say, and drives give the torque that they are commanded.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rt/core/gate_config.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Time constant of the comparison of a position with its speed.
inline constexpr double kSpeedCompare_s = 0.5;
/// Fault: a joint's position and the integral of its speed disagree by this much, rad.
inline constexpr double kSpeedDisagrees_rad = 0.3;
/// Fault: the reported torque differs from the commanded one by this share of the joint's limit ...
inline constexpr double kTorqueMissingShare = 0.15;
inline constexpr double kTorqueMissing_s = 0.04;  ///< ... for this long
/// Fault in StandUp and Stand: a joint is this far from its target ...
inline constexpr double kNotFollowing_rad = 0.6;
inline constexpr double kNotFollowing_s = 0.05;  ///< ... for this long; in Stand kHeld_s
/// Fault in Walk: a joint stays within this ...
inline constexpr double kHeld_rad = 0.01;
/// ... while its target is this far away from the joint, and from where it was when the joint came
/// to rest, ...
inline constexpr double kHeldTarget_rad = 0.3;
inline constexpr double kHeld_s = 0.2;  ///< ... for this long. Sound robots walk with 0.13 at most.
/// Fault: a joint stays within this, a count of a coarse encoder, ...
inline constexpr double kStill_rad = 0.0005;
/// ... while its target is this far away from where it was when the joint came to rest; a robot
/// that stands up may press against something; ...
inline constexpr double kStillTarget_rad = 0.4, kStillTargetInWalk_rad = 0.2;
inline constexpr double kStill_s = 0.1;  ///< ... for this long.
/// Fault in Stand: another joint of a leg is pushed away by this much, while one stays the same to
/// the bit, ...
inline constexpr double kPushed_rad = 0.04;
inline constexpr double kPushed_s = 0.025;  ///< ... for this long. Away from its mean over ...
inline constexpr double kPushedFrom_s = 0.5;
inline constexpr double kSettled_s = 1.0;  ///< After this time in Stand; before, the robot settles.
/// Motion of the body while all joints stay the same to the bit, each beyond what a robot at
/// rest shows: a turn of 0.1 rad or 0.3 m/s of vertical speed are a fault.
inline constexpr double kBodyRest_radps = 0.1, kBodyTurn_rad = 0.1;
inline constexpr double kBodyRest_mps2 = 0.5, kBodySinks_mps = 0.3;
/// Speed that a braked joint at rest may report: some steps of the coarsest drive's speed.
inline constexpr double kRest_radps = 0.05;
/// A gap between two samples that is longer than this, and longer than joints_fault_ticks, is a
/// stall of the loop.
inline constexpr std::uint64_t kShortestGap_ticks = 8;
/// A joint that was silent for longer than this while the loop ran may have lost its zero, and so
/// may every joint after a stall in which a drive has time to restart.
inline constexpr std::uint64_t kSilent_ticks = 200, kRestart_ticks = 1000;
/// A doubt ends when all joints have stayed within this of where they are, in the lying pose, ...
inline constexpr double kFoldedStill_rad = 0.01;
inline constexpr double kFolded_s = 0.5;  ///< ... for this long, the drives off.
/// Fault on arming: else such a joint is farther than this from where it was and from the lying
/// pose, rad. One turn of a motor moves the zero of a 6.75:1 drive by 0.93 rad.
inline constexpr double kMisplaced_rad = 0.3;

/// Joints that rest while they are commanded elsewhere.
struct JointRest {
  JointArray<double> rad{};           ///< position near which the joint rests
  JointArray<double> target_rad{};    ///< commanded position when it came there
  JointArray<std::uint64_t> ticks{};  ///< for which that has been far away
};

/// What is remembered of the joints. All members 64 bits wide.
struct JointMemory {
  double body_motion = 0.0;     ///< of the body since a joint last changed; 1 is too much
  std::uint64_t body_tick = 0;  ///< newest sample then
  std::uint64_t seen = 0;       ///< 1: the next three are those of the last judgement
  JointArray<std::uint64_t> sample_tick{};
  JointArray<double> position_rad{};
  JointArray<double> velocity_radps{};

  JointArray<std::uint64_t> changed_tick{};  ///< sample since which they have had the same bits
  JointArray<double> frozen_target_rad{};    ///< commanded position at the last change
  JointArray<std::uint64_t> frozen_ticks{};  ///< for which it has been far from that
  JointRest still;                           ///< of an encoder that is stuck
  JointRest held;                            ///< of a joint that something holds
  /// Of each joint's leg, while the joint rests: low-passed positions and commanded positions.
  JointArray<LegJoints<double>> leg_position_rad{}, leg_target_rad{};
  std::uint64_t stand_tick = 0;              ///< newest sample outside Stand
  JointArray<std::uint64_t> pushed_ticks{};  ///< for which the leg's others have been elsewhere
  JointArray<double> drift_rad{};            ///< change of position, less the integral of the speed

  JointArray<double> commanded_nm{};  ///< torque of the last command, at the values then measured
  std::uint64_t commanded = 0;        ///< 1: there was one
  JointArray<std::uint64_t> torque_missing_ticks{}, behind_ticks{};

  std::uint64_t unsure_joints = 0;  ///< that may have lost their zero, bit j for joint j
  std::uint64_t known_joints = 0;   ///< of these, those that were somewhere before
  JointArray<double> known_rad{};   ///< where
  JointArray<double> folded_rad{};  ///< where all joints are still, in the lying pose, ...
  std::uint64_t folded_tick = 0;    ///< ... and since when
};
static_assert(sizeof(JointMemory) == 8 * (8 + 25 * kNumJoints), "no padding");

/// The latest stall of the loop.
struct Stall {
  std::uint64_t end_tick = 0, ticks = 0;

  /// How many of its ticks came after `tick`.
  std::uint64_t since(std::uint64_t tick) const noexcept {
    return tick < end_tick ? std::min(ticks, end_tick - tick) : 0;
  }
};

/// What a judgement of joints rests on besides their values.
struct JointContext {
  Mode mode = Mode::kPassive;
  Mode mode_before = Mode::kPassive;   ///< in which the last judgement left the robot
  const ImuSample* imu = nullptr;      ///< null: not usable, or the robot hangs
  bool stiff = false;                  ///< the last command had stiffness
  const JointArray<double>& sent_rad;  ///< its positions
  Stall stall = {};
};

struct JointVerdict {
  std::uint64_t faults = 0;  ///< bits of Fault
  std::uint64_t joints = 0;  ///< that they are about
  std::uint64_t blind = 0;   ///< joints that damping by their own speed would drive
};

/// Judges the new samples of finite values, and remembers them.
JointVerdict judge_samples(const GateConfig& config, const JointState& joints,
                           const JointContext& context, JointMemory& memory) noexcept;

}  // namespace sandrunner
