// SPDX-License-Identifier: BSD-3-Clause
// What a step is rewarded for. To add a reward: its struct here, with its name in `Rewards`, and
// its table in training.toml.
#pragma once

#include <algorithm>
#include <cmath>

#include "tools/train/task/gait_prior.h"
#include "tools/train/task/reward_terms.h"
#include "tools/train/task/step_outcome.h"

namespace sandrunner::train {
namespace reward {

/// How well the commanded velocity is kept.
struct Velocity {
  static constexpr const char* kName = "velocity";
  double weight = 0;
  double width = 0;             ///< of the squared error, m^2/s^2
  double width_per_speed2 = 0;  ///< and for each m^2/s^2 of commanded speed
  static constexpr Setting<Velocity> kSettings[] = {
      {"weight", &Velocity::weight, 0.0, kNoLimit},
      {"width", &Velocity::width, 1e-6, 1e3},
      {"width_per_speed2", &Velocity::width_per_speed2, 0.0, kNoLimit},
  };
  /// 1 exactly at the command, towards 0 far from it. The curricula look at this too. Sideways it
  /// is that of the last stride: a trot's swing is no error.
  float kernel(const StepOutcome& s) const {
    const double ex = s.command[0] - s.vx, ey = s.command[1] - s.drift[1];
    return static_cast<float>(
        std::exp(-(ex * ex + ey * ey) / (width + width_per_speed2 * command_speed2(s))));
  }
  double value(const StepOutcome& s, const RewardSchedule&) const { return weight * kernel(s); }
};

/// Share of the commanded motion that is made: nothing for a robot that stands still.
struct Progress {
  static constexpr const char* kName = "progress";
  double weight = 0;
  static constexpr Setting<Progress> kSettings[] = {
      {"weight", &Progress::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    const double speed2 = command_speed2(s);
    if (!(speed2 > 0.01)) return 0.0;
    const double along = s.drift[0] * s.command[0] + s.drift[1] * s.command[1];
    return weight * made(along / speed2);
  }
};

struct Yaw {
  static constexpr const char* kName = "yaw";
  double weight = 0;
  double width = 0;  ///< of the squared error, rad^2/s^2
  static constexpr Setting<Yaw> kSettings[] = {
      {"weight", &Yaw::weight, 0.0, kNoLimit},
      {"width", &Yaw::width, 1e-6, 1e3},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    const double yaw_error = s.command[2] - s.drift[2];  // a trot's swing is no error
    return weight * std::exp(-yaw_error * yaw_error / width);
  }
};

/// Share of the commanded turn that is made.
struct YawProgress {
  static constexpr const char* kName = "yaw_progress";
  double weight = 0;
  static constexpr Setting<YawProgress> kSettings[] = {
      {"weight", &YawProgress::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    if (!(std::fabs(s.command[2]) > 0.1f)) return 0.0;
    return weight * made(s.drift[2] / s.command[2]);
  }
};

/// Pointed kernels of the velocities without the gait's own swing: every bit of drift counts.
/// Nothing for standing still under a command to go.
struct Precise {
  static constexpr const char* kName = "precise";
  double forward_weight = 0;
  double forward_width = 0;            ///< of the error, m/s
  double forward_width_per_speed = 0;  ///< and for each m/s of |commanded vx|
  double drift_weight = 0;
  double drift_late_factor = 0;
  double lateral_width = 0;  ///< of the error, m/s
  double yaw_width = 0;      ///< of the error, rad/s
  static constexpr Setting<Precise> kSettings[] = {
      {"forward_weight", &Precise::forward_weight, 0.0, kNoLimit},
      {"forward_width", &Precise::forward_width, 1e-6, 1e3},
      {"forward_width_per_speed", &Precise::forward_width_per_speed, 0.0, kNoLimit},
      {"drift_weight", &Precise::drift_weight, 0.0, kNoLimit},
      {"drift_late_factor", &Precise::drift_late_factor, 0.0, kNoLimit},
      {"lateral_width", &Precise::lateral_width, 1e-6, 1e3},
      {"yaw_width", &Precise::yaw_width, 1e-6, 1e3},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    const double ex = std::fabs(s.command[0] - s.drift[0]),
                 ey = std::fabs(s.command[1] - s.drift[1]),
                 ew = std::fabs(s.command[2] - s.drift[2]);
    const double width = forward_width + forward_width_per_speed * std::fabs(double(s.command[0]));
    return progress(s) * (forward_weight * std::exp(-ex / width) +
                          drift_weight * schedule.grown(drift_late_factor) *
                              std::exp(-ey / lateral_width - ew / yaw_width));
  }
};

/// Swings and stances up to a length; under a command to stand, stances only. Per s.
struct Air {
  static constexpr const char* kName = "air";
  double weight = 0;
  double target_s = 0;          ///< longest swing and stance that are rewarded in full
  double longest_swing_s = 0;   ///< a longer swing is not rewarded at all
  double longest_stance_s = 0;  ///< a longer stance is not rewarded at all
  static constexpr Setting<Air> kSettings[] = {
      {"weight", &Air::weight, 0.0, kNoLimit},
      {"target_s", &Air::target_s, 1e-3, 10.0},
      {"longest_swing_s", &Air::longest_swing_s, 0.0, kNoLimit},
      {"longest_stance_s", &Air::longest_stance_s, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule&) const {
    // penalty::Pose has another limit for a command to stand; commands between the two are rare.
    const bool still = command_speed2(s) < 1e-4 && std::fabs(s.command[2]) < 1e-2f;
    double air = 0.0;
    for (int l = 0; l < kNumLegs; ++l) {
      if (still) {
        air += std::clamp<double>(s.stance_s[l] - s.air_s[l], -target_s, target_s);
      } else if (s.contact[l]) {
        if (s.stance_s[l] < longest_stance_s) air += std::min<double>(s.stance_s[l], target_s);
      } else if (s.air_s[l] < longest_swing_s) {
        air += std::min<double>(s.air_s[l], target_s);
      }
    }
    return weight * air;
  }
};

/// Diagonal feet together; fades with the prior.
struct Diagonality {
  static constexpr const char* kName = "diagonality";
  double weight = 0;
  static constexpr Setting<Diagonality> kSettings[] = {
      {"weight", &Diagonality::weight, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    return schedule.prior * weight * diagonality(s);
  }
};

/// A diagonal pair in the air while the other one carries; fades with the prior.
struct PairedSwing {
  static constexpr const char* kName = "paired_swing";
  double weight = 0;
  double target_s = 0;   ///< longest swing of a pair that is rewarded in full
  double longest_s = 0;  ///< a longer swing is not rewarded at all
  static constexpr Setting<PairedSwing> kSettings[] = {
      {"weight", &PairedSwing::weight, 0.0, kNoLimit},
      {"target_s", &PairedSwing::target_s, 1e-3, 10.0},
      {"longest_s", &PairedSwing::longest_s, 0.0, kNoLimit},
  };
  double value(const StepOutcome& s, const RewardSchedule& schedule) const {
    return schedule.prior * weight * paired_swing(s, target_s, longest_s);
  }
};

}  // namespace reward

/// The inner sum decides how the whole is rounded: without it the weights of every seed would be
/// others.
using Rewards = Sum<reward::Velocity, reward::Progress, reward::Yaw, reward::YawProgress,
                    reward::Precise, reward::Air, Sum<reward::Diagonality, reward::PairedSwing>>;

}  // namespace sandrunner::train
