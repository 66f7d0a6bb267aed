// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/joint_judge.h"

#include <algorithm>
#include <cmath>

#include "rt/core/faults.h"
#include "rt/core/rotation.h"
#include "rt/core/same_bits.h"

namespace sandrunner {
namespace {

double seconds(std::uint64_t ticks) noexcept {
  return kControlPeriod_s * static_cast<double>(ticks);
}

/// How fast the body uses up what a joint at rest may miss of its motion, 1/s.
double motion_rate(const ImuSample& imu) noexcept {
  const double turns_radps = length(imu.angular_velocity_radps);
  const double felt_mps2 = rotated(imu.orientation_wxyz, imu.linear_acceleration_mps2)[2];
  const double sinks_mps2 = std::fabs(felt_mps2 - kGravity_mps2);
  return std::max(turns_radps - kBodyRest_radps, 0.0) / kBodyTurn_rad +
         std::max(sinks_mps2 - kBodyRest_mps2, 0.0) / kBodySinks_mps;
}

bool repeats(const JointState& joints, int j, const JointMemory& m) noexcept {
  return same_bits(joints.position_rad[j], m.position_rad[j]) &&
         same_bits(joints.velocity_radps[j], m.velocity_radps[j]);
}

/// Whether all joints stay the same to the bit while the body moves. One that rests may well repeat
/// the codes of a coarse encoder while the others move.
bool body_moves_alone(const JointState& joints, const JointContext& context,
                      JointMemory& m) noexcept {
  const bool carries = (kCarrying & mode_set(context.mode)) != 0;
  bool all_repeat = m.seen != 0 && carries && context.imu != nullptr;
  for (int j = 0; j < kNumJoints && all_repeat; ++j) all_repeat = repeats(joints, j, m);
  const std::uint64_t newest = *std::ranges::max_element(joints.tick);
  m.body_motion =
      all_repeat ? m.body_motion + motion_rate(*context.imu) * seconds(newest - m.body_tick) : 0.0;
  m.body_tick = newest;
  return m.body_motion > 1.0;
}

/// Whether the values of joint j stay the same while its own speed says that it moves.
bool frozen_in_motion(const GateConfig& config, const JointState& joints, int j,
                      const JointContext& context, JointMemory& m) noexcept {
  const bool braked = context.mode == Mode::kDamping || context.mode == Mode::kFault;
  if (!repeats(joints, j, m) || (!context.stiff && !braked)) {
    m.changed_tick[j] = joints.tick[j];
    return false;
  }
  const double speed_radps = std::fabs(joints.velocity_radps[j]);
  const bool moves =
      speed_radps * seconds(joints.tick[j] - m.changed_tick[j]) > config.frozen_moved_rad;
  const bool may_rest = braked || context.mode == Mode::kStand;
  return moves && !(may_rest && speed_radps <= kRest_radps);
}

/// A joint rests within `within_rad` of a place, its target farther than `away_rad` from where it
/// was when the joint came there, and at least `push_rad` from the joint.
struct RestLimits {
  double within_rad, away_rad, push_rad;
};

/// For how many ticks, in all that count, joint j has rested so.
std::uint64_t rest_ticks(const JointState& joints, int j, double target_rad, bool counts,
                         const RestLimits& limits, const JointMemory& m, JointRest& rest) noexcept {
  const double position_rad = joints.position_rad[j];
  if (!counts || std::fabs(position_rad - rest.rad[j]) > limits.within_rad) {
    rest.rad[j] = position_rad;
    rest.target_rad[j] = target_rad;
    rest.ticks[j] = 0;
  } else if (std::fabs(target_rad - rest.target_rad[j]) > limits.away_rad &&
             std::fabs(target_rad - position_rad) >= limits.push_rad) {
    rest.ticks[j] += joints.tick[j] - m.sample_tick[j];
  }
  return rest.ticks[j];
}

/// Whether joint j has stayed where it is for long since its target moved away: to the bit, or to a
/// count of an encoder that is stuck.
bool ignores_target(const GateConfig& config, const JointState& joints, int j,
                    const JointContext& context, JointMemory& m) noexcept {
  const double target_rad = context.sent_rad[j];
  if (!context.stiff || m.changed_tick[j] == joints.tick[j]) {
    m.frozen_target_rad[j] = target_rad;
    m.frozen_ticks[j] = 0;
  } else if (std::fabs(target_rad - m.frozen_target_rad[j]) > config.frozen_commanded_rad) {
    m.frozen_ticks[j] += joints.tick[j] - m.sample_tick[j];
  }
  const double away_rad = context.mode == Mode::kWalk ? kStillTargetInWalk_rad : kStillTarget_rad;
  const std::uint64_t still =
      rest_ticks(joints, j, target_rad, context.stiff, {kStill_rad, away_rad, 0.0}, m, m.still);
  return m.frozen_ticks[j] >= config.frozen_ticks || still >= ticks_from_s(kStill_s);
}

/// Whether joint j has stayed the same to the bit while something pushes the other joints of its
/// leg from where they stand: of a leg that stands, no joint is spared. One that rests may repeat
/// the codes of a coarse encoder while the others are commanded elsewhere or sink slowly.
/// Called in Stand only.
bool rests_alone(const JointState& joints, int j, const JointContext& context,
                 JointMemory& m) noexcept {
  const int first = j - j % kJointsPerLeg;
  const bool settled = joints.tick[j] > m.stand_tick + ticks_from_s(kSettled_s);
  const bool rests = settled && context.stiff && m.changed_tick[j] != joints.tick[j];
  const std::uint64_t ticks = joints.tick[j] - m.sample_tick[j];
  const double share = rests ? std::min(seconds(ticks) / kPushedFrom_s, 1.0) : 1.0;
  bool pushed = false;
  for (int k = 0; k < kJointsPerLeg; ++k) {
    const auto follow = [&](double rad, double& mean_rad) {
      mean_rad += share * (rad - mean_rad);
      return std::fabs(rad - mean_rad);
    };
    const double moved_rad = follow(joints.position_rad[first + k], m.leg_position_rad[j][k]);
    const double told_rad = follow(context.sent_rad[first + k], m.leg_target_rad[j][k]);
    pushed = pushed || (moved_rad > kPushed_rad && told_rad < 0.25 * kPushed_rad);
  }
  std::uint64_t& pushed_ticks = m.pushed_ticks[j];
  pushed_ticks = rests && pushed ? pushed_ticks + ticks : 0;
  return pushed_ticks >= ticks_from_s(kPushed_s);
}

/// Whether the position of joint j has changed by something else than its speed.
bool speed_disagrees(const GateConfig& config, const JointState& joints, int j,
                     JointMemory& m) noexcept {
  const std::uint64_t ticks = joints.tick[j] - m.sample_tick[j];
  // A longer gap is a stall of the loop, through which nothing is known of the motion.
  if (ticks > std::max(config.joints_fault_ticks, kShortestGap_ticks)) return false;
  double& drift_rad = m.drift_rad[j];
  drift_rad += joints.position_rad[j] - m.position_rad[j] -
               0.5 * seconds(ticks) * (joints.velocity_radps[j] + m.velocity_radps[j]) -
               drift_rad * (seconds(ticks) / kSpeedCompare_s);
  return std::fabs(drift_rad) > kSpeedDisagrees_rad;
}

/// Whether the drive of joint j has long given another torque than it was commanded.
bool torque_missing(const GateConfig& config, const JointState& joints, int j,
                    JointMemory& m) noexcept {
  const double commanded_nm = m.commanded_nm[j], speed_radps = joints.velocity_radps[j];
  const bool away = std::fabs(commanded_nm - joints.torque_nm[j]) >
                    kTorqueMissingShare * config.torque_limit_nm[j];
  // What no drive can give: the torque-speed line leaves less and less to a joint that drives fast.
  const bool too_fast = commanded_nm * speed_radps > 0.0 &&
                        std::fabs(speed_radps) > 0.5 * config.speed_limit_radps[j];
  std::uint64_t& ticks = m.torque_missing_ticks[j];
  ticks = m.commanded != 0 && away && !too_fast ? ticks + joints.tick[j] - m.sample_tick[j] : 0;
  return ticks > ticks_from_s(kTorqueMissing_s);
}

/// Whether something has long held joint j away from its target, or in its place.
bool not_following(const JointState& joints, int j, const JointContext& context,
                   JointMemory& m) noexcept {
  const double target_rad = context.sent_rad[j];
  const bool stands = context.mode == Mode::kStand;
  const bool behind = (stands || context.mode == Mode::kStandUp) && context.stiff &&
                      std::fabs(target_rad - joints.position_rad[j]) > kNotFollowing_rad;
  std::uint64_t& ticks = m.behind_ticks[j];
  ticks = behind ? ticks + joints.tick[j] - m.sample_tick[j] : 0;
  const bool walks = context.mode == Mode::kWalk && context.stiff;
  const std::uint64_t held = rest_ticks(joints, j, target_rad, walks,
                                        {kHeld_rad, kHeldTarget_rad, kHeldTarget_rad}, m, m.held);
  return ticks > ticks_from_s(stands ? kHeld_s : kNotFollowing_s) || held > ticks_from_s(kHeld_s);
}

bool near(double a_rad, double b_rad) noexcept {
  return std::fabs(a_rad - b_rad) <= kMisplaced_rad;
}

bool lies(const GateConfig& config, const JointState& joints) noexcept {
  for (int j = 0; j < kNumJoints; ++j) {
    if (!near(joints.position_rad[j], config.lying_rad[j])) return false;
  }
  return true;
}

/// Whether all joints have been still in the lying pose for long enough: its legs were
/// folded by hand. (They may sag after that. A leg that is moved only passes the pose, with any
/// offset.)
bool was_folded(const GateConfig& config, const JointState& joints, JointMemory& m) noexcept {
  const auto [oldest, newest] = std::ranges::minmax(joints.tick);
  bool still = lies(config, joints) && newest - oldest <= kSilent_ticks;
  for (int j = 0; j < kNumJoints && still; ++j) {
    still = std::fabs(joints.position_rad[j] - m.folded_rad[j]) <= kFoldedStill_rad;
  }
  if (!still) {
    m.folded_rad = joints.position_rad;
    m.folded_tick = newest;
  }
  return newest - m.folded_tick >= ticks_from_s(kFolded_s);
}

/// Whether a sample comes after a silence in which the joint may have lost its zero. In a short
/// stall of the loop drives go on.
bool was_silent(std::uint64_t tick, std::uint64_t before, const JointContext& context) noexcept {
  const std::uint64_t gap = tick - before;
  return gap > kRestart_ticks || gap - std::min(context.stall.since(before), gap) > kSilent_ticks;
}

/// A joint that comes back after a silence may have lost its zero.
void doubt(int j, JointMemory& m) noexcept {
  const std::uint64_t joint = std::uint64_t{1} << j;
  if ((m.unsure_joints & joint) == 0) {
    m.known_joints |= joint;
    m.known_rad[j] = m.position_rad[j];
  }
  m.unsure_joints |= joint;
}

/// The joints whose zero nothing vouches for: neither where they were nor where a lying robot has
/// them.
std::uint64_t misplaced(const GateConfig& config, const JointState& joints,
                        const JointMemory& m) noexcept {
  std::uint64_t found = 0;
  for (int j = 0; j < kNumJoints; ++j) {
    const std::uint64_t joint = std::uint64_t{1} << j;
    const double rad = joints.position_rad[j];
    const bool known = (m.known_joints & joint) != 0 && near(rad, m.known_rad[j]);
    if (!known && !near(rad, config.lying_rad[j])) found |= m.unsure_joints & joint;
  }
  return found;
}

}  // namespace

JointVerdict judge_samples(const GateConfig& config, const JointState& joints,
                           const JointContext& context, JointMemory& memory) noexcept {
  JointVerdict verdict;
  JointMemory& m = memory;
  const Mode mode = context.mode;
  const bool driven = (kDriven & mode_set(mode)) != 0;
  const bool all_frozen = body_moves_alone(joints, context, m);
  const bool stands = mode == Mode::kStand;
  if (!stands || m.seen == 0) m.stand_tick = m.body_tick;  // the newest
  // All joints of a robot that starts are in doubt, unless it lies. (A simulated one may start in
  // Walk.)
  if (m.seen == 0 && !driven && !lies(config, joints)) m.unsure_joints = kAllJoints;
  for (int j = 0; j < kNumJoints; ++j) {
    if (m.seen != 0 && joints.tick[j] <= m.sample_tick[j]) continue;  // no new sample
    const std::uint64_t joint = std::uint64_t{1} << j;
    std::uint64_t faults = 0;
    const auto find = [&](bool found, Fault fault) {
      if (found && judged_in(mode, fault)) faults |= fault_bit(fault);
      return found;
    };
    if (m.seen != 0) {
      if (was_silent(joints.tick[j], m.sample_tick[j], context)) doubt(j, m);
      const double way_rad = std::fabs(joints.position_rad[j] - m.position_rad[j]);
      const double reach_rad =
          config.encoder_jump_rad +
          config.speed_fault_radps[j % kJointsPerLeg] * seconds(joints.tick[j] - m.sample_tick[j]);
      find(way_rad > reach_rad, Fault::kEncoderJump);
      const bool frozen = all_frozen || frozen_in_motion(config, joints, j, context, m);
      const bool ignores = ignores_target(config, joints, j, context, m);
      const bool alone = stands && rests_alone(joints, j, context, m);
      find(frozen || ignores || alone, Fault::kEncoderFrozen);
      if (!driven && mode != Mode::kFault) m.drift_rad[j] = 0.0;
      const bool disagrees = find(speed_disagrees(config, joints, j, m), Fault::kSpeedMismatch);
      if (mode == Mode::kFault && (frozen || disagrees)) verdict.blind |= joint;
      find(torque_missing(config, joints, j, m), Fault::kTorqueMissing);
      find(not_following(joints, j, context, m), Fault::kNotFollowing);
    } else {
      m.changed_tick[j] = joints.tick[j];
      m.still.rad[j] = m.held.rad[j] = joints.position_rad[j];
    }
    if (faults != 0) verdict.joints |= joint;
    verdict.faults |= faults;
    m.sample_tick[j] = joints.tick[j];
    m.position_rad[j] = joints.position_rad[j];
    m.velocity_radps[j] = joints.velocity_radps[j];
  }
  m.seen = 1;
  if (!driven && was_folded(config, joints, m)) m.unsure_joints = m.known_joints = 0;
  const bool arming = mode == Mode::kDamping && context.mode_before == Mode::kPassive;
  if (arming && !config.hanging) {
    const std::uint64_t joints_off = misplaced(config, joints, m);
    if (joints_off != 0) verdict.faults |= fault_bit(Fault::kJointMisplaced);
    verdict.joints |= joints_off;
  } else if (driven && (kDriven & mode_set(context.mode_before)) != 0) {
    m.unsure_joints = m.known_joints = 0;  // it was armed, or it starts on its feet
  }
  return verdict;
}

}  // namespace sandrunner
