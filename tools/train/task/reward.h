// SPDX-License-Identifier: BSD-3-Clause
// The reward of a policy step: scale * (bounded(what is paid - ramp * what is charged) - what is
// always charged). The bound is there so that no sum of prices makes lying down the better choice:
// early it cuts at zero; later sums below -debt count ever less, but they count. Where everything
// is cut, as it else is on soft soil at speed, no price is felt, and falling costs nothing.
//
// A new term is a function here, its row in kPaid, kCharged or kAlwaysCharged, which also makes it
// a column of the learning curve, and its settings in RewardSettings and kRewardSettings, with
// values in training.toml.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "tools/train/task/gait_prior.h"
#include "tools/train/task/settings.h"
#include "tools/train/task/step_outcome.h"

namespace sandrunner::train {

/// Table `reward` of training.toml. Weights are rewards a step, before `scale`; those of the costs
/// are per unit of what is charged.
struct RewardSettings {
  double scale = 0;                    ///< of the whole, before the critic sees it
  double cost_weight = 0;              ///< of all costs
  double cost_ramp_start = 0;          ///< factor of the costs at the start of the training
  double cost_ramp_transitions = 0;    ///< transitions at which that factor is 1
  double cost_end = 0;                 ///< factor of the costs at the end
  double energy_end = 0;               ///< factor of the energy besides, at the end
  double base_vertical_end = 0;        ///< factor of base_vertical besides, at the end
  double speed_excess_end = 0;         ///< factor of speed_excess besides, at the end
  double precise_drift_end = 0;        ///< factor of precise_drift_weight at the end
  double height_end_m = 0;             ///< height_m at the end
  double prior_start_transitions = 0;  ///< transitions from which the prior fades ...
  double prior_end_transitions = 0;    ///< ... and at which it is gone

  double velocity_weight = 0;
  double velocity_width = 0;             ///< of the squared error, m^2/s^2
  double velocity_width_per_speed2 = 0;  ///< and for each m^2/s^2 of commanded speed
  double progress_weight = 0;
  double yaw_weight = 0;
  double yaw_width = 0;  ///< of the squared error, rad^2/s^2
  double yaw_progress_weight = 0;
  double precise_time_s = 0;  ///< over which velocities are averaged into `drift`
  double precise_forward_weight = 0;
  double precise_forward_width = 0;            ///< of the error, m/s
  double precise_forward_width_per_speed = 0;  ///< and for each m/s of |commanded vx|
  double precise_drift_weight = 0;
  double precise_lateral_width = 0;  ///< of the error, m/s
  double precise_yaw_width = 0;      ///< of the error, rad/s
  double air_weight = 0;             ///< per s
  double air_target_s = 0;           ///< longest swing and stance that are paid in full
  double air_longest_s = 0;          ///< a longer swing is not paid at all
  double stance_longest_s = 0;       ///< a longer stance is not paid at all
  double diagonality = 0;            ///< prior
  double paired_swing = 0;           ///< prior
  double paired_swing_target_s = 0;  ///< longest swing of a pair that is paid in full

  double torque = 0;              ///< per N^2 m^2
  double power = 0;               ///< per W
  double energy_speed_mps = 0;    ///< energy counts times this speed over ...
  double energy_offset_mps = 0;   ///< ... the sum of this one and the commanded
  double joint_speed = 0;         ///< per rad^2/s^2
  double speed_excess = 0;        ///< per rad^2/s^2
  double slip = 0;                ///< per m^2/s^2
  double smoothness_1 = 0;        ///< per square of the action's change
  double smoothness_2 = 0;        ///< per square of the change of that
  double short_stride = 0;        ///< per s that a stride is shorter than the next, at the end
  double stride_shortest_s = 0;   ///< from touchdown to touchdown of a foot
  double pose = 0;                ///< per rad^2 off the nominal pose
  double pose_flexion_share = 0;  ///< of that, for HFE and KFE
  double joint_margin = 0;        ///< per rad of a knee past one of the next two
  double knee_low_rad = 0;
  double knee_high_rad = 0;
  double orientation = 0;      ///< per rad^2 of tilt
  double base_vertical = 0;    ///< per m^2/s^2
  double base_roll_pitch = 0;  ///< per rad/s
  double height = 0;           ///< per m^2 below height_m
  double height_m = 0;         ///< of the base above the deformed ground
  double clearance = 0;        ///< per m^2 below clearance_m, times the root of the foot's speed
  double clearance_m = 0;      ///< of a foot in the air above the surface
  double debt = 0;             ///< sums of a step below -debt count ever less, at the end
  double joint_stop = 0;       ///< of a step with a joint past its stop, at the end
  double fall = 0;             ///< of a fall, at the end; besides what is not earned after it
};

/// What read_task_config reads, with the ranges.
inline constexpr NumberSetting<RewardSettings> kRewardSettings[] = {
    {"scale", &RewardSettings::scale, 1e-9, 1e3},
    {"cost_weight", &RewardSettings::cost_weight, 0.0, kNoLimit},
    {"cost_ramp_start", &RewardSettings::cost_ramp_start, 0.0, kNoLimit},
    {"cost_ramp_transitions", &RewardSettings::cost_ramp_transitions, 1.0, 1e12},
    {"cost_end", &RewardSettings::cost_end, 0.0, kNoLimit},
    {"energy_end", &RewardSettings::energy_end, 0.0, kNoLimit},
    {"base_vertical_end", &RewardSettings::base_vertical_end, 0.0, kNoLimit},
    {"speed_excess_end", &RewardSettings::speed_excess_end, 0.0, kNoLimit},
    {"precise_drift_end", &RewardSettings::precise_drift_end, 0.0, kNoLimit},
    {"height_end_m", &RewardSettings::height_end_m, 0.0, kNoLimit},
    {"prior_start_transitions", &RewardSettings::prior_start_transitions, 0.0, 1e12},
    {"prior_end_transitions", &RewardSettings::prior_end_transitions, 0.0, 1e12},
    {"velocity_weight", &RewardSettings::velocity_weight, 0.0, kNoLimit},
    {"velocity_width", &RewardSettings::velocity_width, 1e-6, 1e3},
    {"velocity_width_per_speed2", &RewardSettings::velocity_width_per_speed2, 0.0, kNoLimit},
    {"progress_weight", &RewardSettings::progress_weight, 0.0, kNoLimit},
    {"yaw_weight", &RewardSettings::yaw_weight, 0.0, kNoLimit},
    {"yaw_width", &RewardSettings::yaw_width, 1e-6, 1e3},
    {"yaw_progress_weight", &RewardSettings::yaw_progress_weight, 0.0, kNoLimit},
    {"precise_time_s", &RewardSettings::precise_time_s, 0.01, 10.0},
    {"precise_forward_weight", &RewardSettings::precise_forward_weight, 0.0, kNoLimit},
    {"precise_forward_width", &RewardSettings::precise_forward_width, 1e-6, 1e3},
    {"precise_forward_width_per_speed", &RewardSettings::precise_forward_width_per_speed, 0.0,
     kNoLimit},
    {"precise_drift_weight", &RewardSettings::precise_drift_weight, 0.0, kNoLimit},
    {"precise_lateral_width", &RewardSettings::precise_lateral_width, 1e-6, 1e3},
    {"precise_yaw_width", &RewardSettings::precise_yaw_width, 1e-6, 1e3},
    {"air_weight", &RewardSettings::air_weight, 0.0, kNoLimit},
    {"air_target_s", &RewardSettings::air_target_s, 1e-3, 10.0},
    {"air_longest_s", &RewardSettings::air_longest_s, 0.0, kNoLimit},
    {"stance_longest_s", &RewardSettings::stance_longest_s, 0.0, kNoLimit},
    {"diagonality", &RewardSettings::diagonality, 0.0, kNoLimit},
    {"paired_swing", &RewardSettings::paired_swing, 0.0, kNoLimit},
    {"paired_swing_target_s", &RewardSettings::paired_swing_target_s, 1e-3, 10.0},
    {"torque", &RewardSettings::torque, 0.0, kNoLimit},
    {"power", &RewardSettings::power, 0.0, kNoLimit},
    {"energy_speed_mps", &RewardSettings::energy_speed_mps, 0.0, 1e3},
    {"energy_offset_mps", &RewardSettings::energy_offset_mps, 1e-3, 1e3},
    {"joint_speed", &RewardSettings::joint_speed, 0.0, kNoLimit},
    {"speed_excess", &RewardSettings::speed_excess, 0.0, kNoLimit},
    {"slip", &RewardSettings::slip, 0.0, kNoLimit},
    {"smoothness_1", &RewardSettings::smoothness_1, 0.0, kNoLimit},
    {"smoothness_2", &RewardSettings::smoothness_2, 0.0, kNoLimit},
    {"short_stride", &RewardSettings::short_stride, 0.0, kNoLimit},
    {"stride_shortest_s", &RewardSettings::stride_shortest_s, 0.0, kNoLimit},
    {"pose", &RewardSettings::pose, 0.0, kNoLimit},
    {"pose_flexion_share", &RewardSettings::pose_flexion_share, 0.0, kNoLimit},
    {"joint_margin", &RewardSettings::joint_margin, 0.0, kNoLimit},
    {"knee_low_rad", &RewardSettings::knee_low_rad, -7.0, 7.0},
    {"knee_high_rad", &RewardSettings::knee_high_rad, -7.0, 7.0},
    {"orientation", &RewardSettings::orientation, 0.0, kNoLimit},
    {"base_vertical", &RewardSettings::base_vertical, 0.0, kNoLimit},
    {"base_roll_pitch", &RewardSettings::base_roll_pitch, 0.0, kNoLimit},
    {"height", &RewardSettings::height, 0.0, kNoLimit},
    {"height_m", &RewardSettings::height_m, 0.0, kNoLimit},
    {"clearance", &RewardSettings::clearance, 0.0, kNoLimit},
    {"clearance_m", &RewardSettings::clearance_m, 0.0, kNoLimit},
    {"debt", &RewardSettings::debt, 0.0, kNoLimit},
    {"joint_stop", &RewardSettings::joint_stop, 0.0, kNoLimit},
    {"fall", &RewardSettings::fall, 0.0, kNoLimit},
};

/// Factors that change during the training. As they stand here: the reward that remains.
struct CostRamp {
  double all = 1.0;    ///< of every cost
  double late = 0.0;   ///< 0 to 1: how much of what comes late in the training is on
  double prior = 0.0;  ///< 1 to exactly 0: of the prior

  /// 1, and in the end `end`.
  double grown(double end) const { return 1.0 + (end - 1.0) * late; }
};

/// Those after so many transitions, with this share of the late penalties.
inline CostRamp cost_ramp_at(const RewardSettings& r, double transitions, double late) {
  const auto passed = [&](double start, double end) {  // 0 to exactly 1
    return std::clamp((transitions - start) / std::max(end - start, 1.0), 0.0, 1.0);
  };
  const double rise = std::min(transitions / r.cost_ramp_transitions, 1.0);
  return {
      .all = r.cost_ramp_start + (1.0 - r.cost_ramp_start) * rise + (r.cost_end - 1.0) * late,
      .late = late,
      .prior = 1.0 - passed(r.prior_start_transitions, r.prior_end_transitions),
  };
}

/// One term of the reward, for a step.
struct RewardTerm {
  const char* name;  ///< column reward_<name> of the learning curve
  double (*value)(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp);
  /// Terms of a group are added up first: it decides how the sum is rounded.
  int group;
};

// What is paid.

inline double velocity_paid(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  return r.velocity_weight * velocity_kernel(s, r.velocity_width, r.velocity_width_per_speed2);
}

/// What a robot that stands still does not get.
inline double progress_paid(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  const double speed2 = command_speed2(s);
  if (!(speed2 > 0.01)) return 0.0;
  const double along = s.drift[0] * s.command[0] + s.drift[1] * s.command[1];
  return r.progress_weight * made(along / speed2);
}

inline double yaw_paid(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  const double yaw_error = s.command[2] - s.drift[2];  // a trot's swing is no error
  return r.yaw_weight * std::exp(-yaw_error * yaw_error / r.yaw_width);
}

inline double yaw_progress_paid(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  if (!(std::fabs(s.command[2]) > 0.1f)) return 0.0;
  return r.yaw_progress_weight * made(s.drift[2] / s.command[2]);
}

/// Pointed kernels of the velocities without the gait's own swing: every bit of drift costs.
/// Nothing for standing still when told to go.
inline double precise_paid(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp) {
  const double ex = std::fabs(s.command[0] - s.drift[0]), ey = std::fabs(s.command[1] - s.drift[1]),
               ew = std::fabs(s.command[2] - s.drift[2]);
  const double width =
      r.precise_forward_width + r.precise_forward_width_per_speed * std::fabs(double(s.command[0]));
  return progress(s) * (r.precise_forward_weight * std::exp(-ex / width) +
                        r.precise_drift_weight * ramp.grown(r.precise_drift_end) *
                            std::exp(-ey / r.precise_lateral_width - ew / r.precise_yaw_width));
}

/// Swings and stances up to a length; told to stand, stances only.
inline double air_paid(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  // `pose_charged` has another limit for a command to stand; commands between the two are rare.
  const bool still = command_speed2(s) < 1e-4 && std::fabs(s.command[2]) < 1e-2f;
  double air = 0.0;
  for (int l = 0; l < kNumLegs; ++l) {
    if (still) {
      air += std::clamp<double>(s.stance_s[l] - s.air_s[l], -r.air_target_s, r.air_target_s);
    } else if (s.contact[l]) {
      if (s.stance_s[l] < r.stance_longest_s)
        air += std::min<double>(s.stance_s[l], r.air_target_s);
    } else if (s.air_s[l] < r.air_longest_s) {
      air += std::min<double>(s.air_s[l], r.air_target_s);
    }
  }
  return r.air_weight * air;
}

inline double diagonality_paid(const StepOutcome& s, const RewardSettings& r,
                               const CostRamp& ramp) {
  return ramp.prior * r.diagonality * diagonality(s);
}

inline double paired_swing_paid(const StepOutcome& s, const RewardSettings& r,
                                const CostRamp& ramp) {
  return ramp.prior * r.paired_swing * paired_swing(s, r.paired_swing_target_s, r.air_longest_s);
}

// What is charged.

/// Energy per distance, not per time: cost of transport counts at every speed. Going sideways or
/// backwards and turning take more energy: charged like going ahead, standing would be cheaper.
inline double energy_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp) {
  const double ahead = s.command[0] > 0.0f ? s.command[0] : -2.0 * s.command[0];
  const double distance = std::hypot(ahead, 2.0 * s.command[1]) + 0.5 * std::fabs(s.command[2]);
  const double energy = r.torque * s.torque_squared + r.power * std::max(s.power, 0.0f);
  return energy * ramp.grown(r.energy_end) * r.energy_speed_mps / (r.energy_offset_mps + distance);
}

inline double joint_speed_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  return r.joint_speed * s.speed_squared;
}

inline double speed_excess_charged(const StepOutcome& s, const RewardSettings& r,
                                   const CostRamp& ramp) {
  return r.speed_excess * ramp.grown(r.speed_excess_end) * s.speed_excess;
}

inline double slip_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  return r.slip * s.slip;
}

inline double smoothness_1_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  double squares = 0.0;
  for (int j = 0; j < kNumJoints; ++j) {
    const double change = s.action[j] - s.action_1[j];
    squares += change * change;
  }
  return r.smoothness_1 * squares;
}

inline double smoothness_2_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  double squares = 0.0;
  for (int j = 0; j < kNumJoints; ++j) {
    const double change = s.action[j] - s.action_1[j];
    const double bend = change - (s.action_1[j] - s.action_2[j]);
    squares += bend * bend;
  }
  return r.smoothness_2 * squares;
}

/// Of feet that touch down too soon after they last did: fast strides strike hard ground more often
/// than they need to. By the time that lacks and not by its square: a step that catches a stumble
/// is a short stride too.
inline double short_stride_charged(const StepOutcome& s, const RewardSettings& r,
                                   const CostRamp& ramp) {
  double lack_s = 0.0;
  for (const float stride_s : s.stride_s) {
    if (stride_s > 0.0f) lack_s += std::max(r.stride_shortest_s - stride_s, 0.0);
  }
  return r.short_stride * ramp.late * lack_s;
}

/// Twice as much when told to stand.
inline double pose_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  const bool still =
      std::fabs(s.command[0]) + std::fabs(s.command[1]) + std::fabs(s.command[2]) < 1e-3f;
  double squares = 0.0;
  for (int j = 0; j < kNumJoints; ++j) {
    const double off = s.q[j] - s.nominal[j];
    squares += (j % 3 == 0 ? 1.0 : r.pose_flexion_share) * off * off;
  }
  return (still ? 2.0 : 1.0) * r.pose * squares;
}

inline double joint_margin_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  double overrun = 0.0;
  for (int j = 2; j < kNumJoints; j += kJointsPerLeg) {
    overrun += std::max(std::max(s.q[j] - r.knee_high_rad, r.knee_low_rad - s.q[j]), 0.0);
  }
  return r.joint_margin * overrun;
}

inline double orientation_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  const double tilt = std::acos(std::clamp<double>(s.up_z, -1.0, 1.0));
  return r.orientation * tilt * tilt;
}

inline double base_vertical_charged(const StepOutcome& s, const RewardSettings& r,
                                    const CostRamp& ramp) {
  return r.base_vertical * ramp.grown(r.base_vertical_end) * s.vz * s.vz;
}

inline double base_roll_pitch_charged(const StepOutcome& s, const RewardSettings& r,
                                      const CostRamp&) {
  return r.base_roll_pitch * (std::fabs(s.roll_rate) + std::fabs(s.pitch_rate));
}

inline double height_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp) {
  const double height_m = r.height_m + (r.height_end_m - r.height_m) * ramp.late;
  const double low = std::max(height_m - s.body_height, 0.0);
  return r.height * low * low;
}

template <int kLeg>
double clearance_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp&) {
  if (s.contact[kLeg]) return 0.0;
  const double lack = std::max(r.clearance_m - s.foot_clearance[kLeg], 0.0);
  return r.clearance * lack * lack * std::sqrt(static_cast<double>(s.foot_speed[kLeg]));
}

inline constexpr RewardTerm kPaid[] = {
    {"velocity", velocity_paid, 0},
    {"progress", progress_paid, 1},
    {"yaw", yaw_paid, 2},
    {"yaw_progress", yaw_progress_paid, 3},
    {"precise", precise_paid, 4},
    {"air", air_paid, 5},
    {"diagonality", diagonality_paid, 6},
    {"paired_swing", paired_swing_paid, 6},
};

inline constexpr RewardTerm kCharged[] = {
    {"energy", energy_charged, 0},
    {"joint_speed", joint_speed_charged, 0},
    {"speed_excess", speed_excess_charged, 0},
    {"slip", slip_charged, 0},
    {"smoothness_1", smoothness_1_charged, 1},
    {"smoothness_2", smoothness_2_charged, 1},
    {"short_stride", short_stride_charged, 1},
    {"pose", pose_charged, 1},
    {"joint_margin", joint_margin_charged, 1},
    {"orientation", orientation_charged, 2},
    {"base_vertical", base_vertical_charged, 2},
    {"base_roll_pitch", base_roll_pitch_charged, 2},
    {"height", height_charged, 3},
    {"clearance_lf", clearance_charged<0>, 4},
    {"clearance_rf", clearance_charged<1>, 5},
    {"clearance_lh", clearance_charged<2>, 6},
    {"clearance_rh", clearance_charged<3>, 7},
};

// What is charged late, beside any bound.

inline double joint_stop_charged(const StepOutcome& s, const RewardSettings& r,
                                 const CostRamp& ramp) {
  return r.joint_stop * ramp.late * s.past_stop;
}

inline double fall_charged(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp) {
  return s.fell ? r.fall * ramp.late : 0.0;
}

inline constexpr RewardTerm kAlwaysCharged[] = {
    {"joint_stop", joint_stop_charged, 0},
    {"fall", fall_charged, 0},
};

inline constexpr std::size_t kBoundedTerms = std::size(kPaid) + std::size(kCharged);
inline constexpr std::size_t kRewardTerms = kBoundedTerms + std::size(kAlwaysCharged);

/// Name of term i, of those paid, then those charged, then those always charged.
constexpr const char* reward_term_name(std::size_t i) {
  if (i < std::size(kPaid)) return kPaid[i].name;
  return i < kBoundedTerms ? kCharged[i - std::size(kPaid)].name
                           : kAlwaysCharged[i - kBoundedTerms].name;
}

/// Sum of the terms; writes each of them to `values`.
template <std::size_t kCount>
double sum_of(const RewardTerm (&terms)[kCount], const StepOutcome& s, const RewardSettings& r,
              const CostRamp& ramp, double* values) {
  double sum = 0.0, group = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (i > 0 && terms[i].group != terms[i - 1].group) {
      sum += group;
      group = 0.0;
    }
    values[i] = terms[i].value(s, r, ramp);
    group += values[i];
  }
  return sum + group;
}

/// Reward of a step, and what each term puts in: paid above zero, charged below; before the scale
/// and the bound.
struct Reward {
  float value = 0;
  std::array<double, kRewardTerms> terms{};
};

/// `sum` down to -debt; from there it falls ever more slowly, at once as fast as `sum`.
inline double bounded(double sum, double debt) {
  if (sum >= -debt) return sum;
  return debt > 0.0 ? -debt - debt * std::log1p((-debt - sum) / debt) : 0.0;
}

inline Reward reward(const StepOutcome& s, const RewardSettings& r, const CostRamp& ramp) {
  Reward out;
  double* const charged_terms = out.terms.data() + std::size(kPaid);
  const double paid = sum_of(kPaid, s, r, ramp, out.terms.data());
  const double charged = sum_of(kCharged, s, r, ramp, charged_terms);
  const double price = r.cost_weight * ramp.all;
  for (std::size_t i = 0; i < std::size(kCharged); ++i) charged_terms[i] *= -price;
  double* const always_terms = out.terms.data() + kBoundedTerms;
  const double always = sum_of(kAlwaysCharged, s, r, ramp, always_terms);
  for (std::size_t i = 0; i < std::size(kAlwaysCharged); ++i) always_terms[i] *= -1.0;
  const double sum = bounded(paid - price * charged, ramp.late * r.debt);
  out.value = static_cast<float>(r.scale * (sum - always));
  return out;
}

}  // namespace sandrunner::train
