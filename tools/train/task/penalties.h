// SPDX-License-Identifier: BSD-3-Clause
// What a step is penalised for. To add a penalty: its struct here, with its name in `Penalties`,
// and its table in training.toml.
#pragma once

#include <algorithm>
#include <cmath>

#include "tools/train/task/reward_terms.h"
#include "tools/train/task/step_outcome.h"

namespace sandrunner::train {
namespace penalty {

/// Energy per distance, not per time: cost of transport counts at every speed. Going sideways or
/// backwards and turning take more energy: penalised like going ahead, standing would be better.
struct Energy {
  static constexpr const char* kName = "energy";
  double torque_weight = 0;  ///< per N^2 m^2
  double power_weight = 0;   ///< per W
  double speed_mps = 0;      ///< energy counts times this speed over ...
  double offset_mps = 0;     ///< ... the sum of this one and the commanded
  double late_factor = 0;
  static constexpr Setting<Energy> kSettings[] = {
      {"torque_weight", &Energy::torque_weight, 0.0, kNoLimit},
      {"power_weight", &Energy::power_weight, 0.0, kNoLimit},
      {"speed_mps", &Energy::speed_mps, 0.0, 1e3},
      {"offset_mps", &Energy::offset_mps, 1e-3, 1e3},
      {"late_factor", &Energy::late_factor, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    const double ahead = s.command[0] > 0.0f ? s.command[0] : -2.0 * s.command[0];
    const double distance = std::hypot(ahead, 2.0 * s.command[1]) + 0.5 * std::fabs(s.command[2]);
    const double energy = torque_weight * s.torque_squared + power_weight * std::max(s.power, 0.0f);
    return energy * schedule.grown(late_factor) * speed_mps / (offset_mps + distance);
  }
};

struct JointSpeed {
  static constexpr const char* kName = "joint_speed";
  double weight = 0;  ///< per rad^2/s^2
  static constexpr Setting<JointSpeed> kSettings[] = {
      {"weight", &JointSpeed::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    return weight * s.speed_squared;
  }
};

/// Joints near their speed limit or beyond it.
struct SpeedExcess {
  static constexpr const char* kName = "speed_excess";
  double weight = 0;  ///< per rad^2/s^2
  double late_factor = 0;
  static constexpr Setting<SpeedExcess> kSettings[] = {
      {"weight", &SpeedExcess::weight, 0.0, kNoLimit},
      {"late_factor", &SpeedExcess::late_factor, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    return weight * schedule.grown(late_factor) * s.speed_excess;
  }
};

struct Slip {
  static constexpr const char* kName = "slip";
  double weight = 0;  ///< per m^2/s^2
  static constexpr Setting<Slip> kSettings[] = {
      {"weight", &Slip::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const { return weight * s.slip; }
};

struct Smoothness1 {
  static constexpr const char* kName = "smoothness_1";
  double weight = 0;  ///< per square of the action's change
  static constexpr Setting<Smoothness1> kSettings[] = {
      {"weight", &Smoothness1::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    double squares = 0.0;
    for (int j = 0; j < kNumJoints; ++j) {
      const double change = s.action[j] - s.action_1[j];
      squares += change * change;
    }
    return weight * squares;
  }
};

struct Smoothness2 {
  static constexpr const char* kName = "smoothness_2";
  double weight = 0;  ///< per square of the change of the action's change
  static constexpr Setting<Smoothness2> kSettings[] = {
      {"weight", &Smoothness2::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    double squares = 0.0;
    for (int j = 0; j < kNumJoints; ++j) {
      const double change = s.action[j] - s.action_1[j];
      const double bend = change - (s.action_1[j] - s.action_2[j]);
      squares += bend * bend;
    }
    return weight * squares;
  }
};

/// Of feet that touch down too soon after they last did: fast strides strike hard ground more often
/// than they need to. By the time that lacks and not by its square: a step that catches a stumble
/// is a short stride too. Late.
struct ShortStride {
  static constexpr const char* kName = "short_stride";
  double weight = 0;      ///< per s that a stride is shorter than the next
  double shortest_s = 0;  ///< from touchdown to touchdown of a foot
  static constexpr Setting<ShortStride> kSettings[] = {
      {"weight", &ShortStride::weight, 0.0, kNoLimit},
      {"shortest_s", &ShortStride::shortest_s, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    double lack_s = 0.0;
    for (const float stride_s : s.stride_s) {
      if (stride_s > 0.0f) lack_s += std::max(shortest_s - stride_s, 0.0);
    }
    return weight * schedule.late * lack_s;
  }
};

/// Joints off their nominal position; twice as much under a command to stand.
struct Pose {
  static constexpr const char* kName = "pose";
  double weight = 0;         ///< per rad^2
  double flexion_share = 0;  ///< of that, for HFE and KFE
  static constexpr Setting<Pose> kSettings[] = {
      {"weight", &Pose::weight, 0.0, kNoLimit},
      {"flexion_share", &Pose::flexion_share, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    const bool still =
        std::fabs(s.command[0]) + std::fabs(s.command[1]) + std::fabs(s.command[2]) < 1e-3f;
    double squares = 0.0;
    for (int j = 0; j < kNumJoints; ++j) {
      const double off = s.q[j] - s.nominal[j];
      squares += (j % 3 == 0 ? 1.0 : flexion_share) * off * off;
    }
    return (still ? 2.0 : 1.0) * weight * squares;
  }
};

struct JointMargin {
  static constexpr const char* kName = "joint_margin";
  double weight = 0;  ///< per rad of a knee past one of the next two
  double knee_low_rad = 0, knee_high_rad = 0;
  static constexpr Setting<JointMargin> kSettings[] = {
      {"weight", &JointMargin::weight, 0.0, kNoLimit},
      {"knee_low_rad", &JointMargin::knee_low_rad, -100.0, 100.0},
      {"knee_high_rad", &JointMargin::knee_high_rad, -100.0, 100.0},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    double overrun = 0.0;
    for (int j = 2; j < kNumJoints; j += kJointsPerLeg) {
      overrun += std::max(std::max(s.q[j] - knee_high_rad, knee_low_rad - s.q[j]), 0.0);
    }
    return weight * overrun;
  }
};

struct Orientation {
  static constexpr const char* kName = "orientation";
  double weight = 0;  ///< per rad^2 of tilt
  static constexpr Setting<Orientation> kSettings[] = {
      {"weight", &Orientation::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    const double tilt = std::acos(std::clamp<double>(s.up_z, -1.0, 1.0));
    return weight * tilt * tilt;
  }
};

struct BaseVertical {
  static constexpr const char* kName = "base_vertical";
  double weight = 0;  ///< per m^2/s^2
  double late_factor = 0;
  static constexpr Setting<BaseVertical> kSettings[] = {
      {"weight", &BaseVertical::weight, 0.0, kNoLimit},
      {"late_factor", &BaseVertical::late_factor, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    return weight * schedule.grown(late_factor) * s.vz * s.vz;
  }
};

struct BaseRollPitch {
  static constexpr const char* kName = "base_roll_pitch";
  double weight = 0;  ///< per rad/s
  static constexpr Setting<BaseRollPitch> kSettings[] = {
      {"weight", &BaseRollPitch::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    return weight * (std::fabs(s.roll_rate) + std::fabs(s.pitch_rate));
  }
};

struct Height {
  static constexpr const char* kName = "height";
  double weight = 0;         ///< per m^2 below the target
  double target_m = 0;       ///< of the base above the deformed ground
  double late_target_m = 0;  ///< likewise, when the late penalties are fully on
  static constexpr Setting<Height> kSettings[] = {
      {"weight", &Height::weight, 0.0, kNoLimit},
      {"target_m", &Height::target_m, 0.0, kNoLimit},
      {"late_target_m", &Height::late_target_m, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    const double height_m = target_m + (late_target_m - target_m) * schedule.late;
    const double low = std::max(height_m - s.body_height, 0.0);
    return weight * low * low;
  }
};

inline constexpr const char* kClearanceNames[] = {"clearance_lf", "clearance_rf", "clearance_lh",
                                                  "clearance_rh"};
/// Of a foot that moves through the air near the surface. A term for each leg decides how the whole
/// is rounded: without it the weights of every seed would be others.
template <int kLeg>
struct Clearance {
  static constexpr const char* kTable = "clearance";
  static constexpr const char* kName = kClearanceNames[kLeg];
  double weight = 0;    ///< per m^2 below the target, times the root of the foot's speed
  double target_m = 0;  ///< of the foot above the surface
  static constexpr Setting<Clearance> kSettings[] = {
      {"weight", &Clearance::weight, 0.0, kNoLimit},
      {"target_m", &Clearance::target_m, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    if (s.contact[kLeg]) return 0.0;
    const double lack = std::max(target_m - s.foot_clearance[kLeg], 0.0);
    return weight * lack * lack * std::sqrt(static_cast<double>(s.foot_speed[kLeg]));
  }
};

/// Of a step with a joint past its stop. Late.
struct JointStop {
  static constexpr const char* kName = "joint_stop";
  double weight = 0;  ///< of a step in which a joint is past its stop all the time
  static constexpr Setting<JointStop> kSettings[] = {
      {"weight", &JointStop::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    return weight * schedule.late * s.past_stop;
  }
};

/// Of a fall, besides what is not earned after it. Late.
struct Fall {
  static constexpr const char* kName = "fall";
  double weight = 0;
  static constexpr Setting<Fall> kSettings[] = {
      {"weight", &Fall::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    return s.fell ? weight * schedule.late : 0.0;
  }
};

}  // namespace penalty

/// The inner sums decide how the whole is rounded: without them the weights of every seed would be
/// others.
using Penalties =
    Sum<Sum<penalty::Energy, penalty::JointSpeed, penalty::SpeedExcess, penalty::Slip>,
        Sum<penalty::Smoothness1, penalty::Smoothness2, penalty::ShortStride, penalty::Pose,
            penalty::JointMargin>,
        Sum<penalty::Orientation, penalty::BaseVertical, penalty::BaseRollPitch>, penalty::Height,
        penalty::Clearance<0>, penalty::Clearance<1>, penalty::Clearance<2>, penalty::Clearance<3>>;

/// Those that count in full however low the sum of a step is.
using UnboundedPenalties = Sum<penalty::JointStop, penalty::Fall>;

}  // namespace sandrunner::train
