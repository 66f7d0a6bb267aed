// SPDX-License-Identifier: BSD-3-Clause
// The reward of a policy step:
//   scale * (bounded(rewards - penalty.weight * schedule.penalty * penalties) - unbounded
//   penalties)
// The bound is there so that no sum of penalties makes lying down the better choice: early it cuts
// at zero; later sums below the floor count ever less, but they count. Where everything is cut, as
// it else is on soft soil at speed, no penalty is felt, and a fall is none.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "tools/train/task/penalties.h"
#include "tools/train/task/rewards.h"

namespace sandrunner::train {

/// Table `penalty` of training.toml, but for the penalties themselves.
struct PenaltySettings {
  double weight = 0;            ///< of all penalties that the floor bounds
  double start_factor = 0;      ///< of them, at the start of the training
  double ramp_transitions = 0;  ///< at which that factor is 1
  double late_factor = 0;       ///< of them, when the late penalties are fully on

  static constexpr Setting<PenaltySettings> kSettings[] = {
      {"weight", &PenaltySettings::weight, 0.0, kNoLimit},
      {"start_factor", &PenaltySettings::start_factor, 0.0, kNoLimit},
      {"ramp_transitions", &PenaltySettings::ramp_transitions, 1.0, 1e12},
      {"late_factor", &PenaltySettings::late_factor, 0.0, kNoLimit},
  };
};

/// Tables `reward` and `penalty` of training.toml.
struct RewardSettings {
  double scale = 0;                    ///< of the whole, before the critic sees it
  double floor = 0;                    ///< sums of a step below it count ever less, late; at most 0
  double drift_time_s = 0;             ///< over which velocities are averaged into `drift`
  double prior_start_transitions = 0;  ///< transitions from which the prior fades ...
  double prior_end_transitions = 0;    ///< ... and at which it is gone
  PenaltySettings penalty;
  Rewards rewards;
  Penalties penalties;
  UnboundedPenalties unbounded_penalties;

  static constexpr Setting<RewardSettings> kSettings[] = {
      {"scale", &RewardSettings::scale, 1e-9, 1e3},
      {"floor", &RewardSettings::floor, -kNoLimit, 0.0},
      {"drift_time_s", &RewardSettings::drift_time_s, 0.01, 10.0},
      {"prior_start_transitions", &RewardSettings::prior_start_transitions, 0.0, 1e12},
      {"prior_end_transitions", &RewardSettings::prior_end_transitions, 0.0, 1e12},
  };

  /// Calls `visit` with the table, "reward" or "penalty", and the term, for each term.
  template <typename Visit>
  void for_each_term(const Visit& visit) {
    rewards.for_each([&](auto& term) { visit("reward", term); });
    penalties.for_each([&](auto& term) { visit("penalty", term); });
    unbounded_penalties.for_each([&](auto& term) { visit("penalty", term); });
  }
};

/// Factors after this many transitions, with this share of the late penalties.
inline RewardSchedule schedule_at(const RewardSettings& r, double transitions, double late) {
  const auto passed = [&](double start, double end) {  // 0 to exactly 1
    return std::clamp((transitions - start) / std::max(end - start, 1.0), 0.0, 1.0);
  };
  const PenaltySettings& p = r.penalty;
  const double rise = std::min(transitions / p.ramp_transitions, 1.0);
  return {
      .penalty = p.start_factor + (1.0 - p.start_factor) * rise + (p.late_factor - 1.0) * late,
      .late = late,
      .prior = 1.0 - passed(r.prior_start_transitions, r.prior_end_transitions),
  };
}

inline constexpr std::size_t kBoundedTerms = Rewards::kTerms + Penalties::kTerms;
inline constexpr std::size_t kRewardTerms = kBoundedTerms + UnboundedPenalties::kTerms;

/// Reward of a step, and what each term puts in: rewards above zero, penalties below; before the
/// scale and the bound.
struct Reward {
  float value = 0;
  std::array<double, kRewardTerms> terms{};
};

/// Column of each term in the learning curve: reward_<name> or penalty_<name>.
inline std::vector<std::string> reward_term_names() {
  std::vector<std::string> names;
  RewardSettings{}.for_each_term([&]<typename Term>(const char* table, Term&) {
    names.push_back(std::string(table) + "_" + Term::kName);
  });
  return names;
}

/// `sum` down to `floor`, which is at most 0; from there it falls ever more slowly, at once as fast
/// as `sum`.
inline double bounded(double sum, double floor) {
  if (sum >= floor) return sum;
  return floor < 0.0 ? floor + floor * std::log1p((floor - sum) / -floor) : 0.0;
}

inline Reward reward_of(const StepOutcome& s, const RewardSettings& r,
                        const RewardSchedule& schedule) {
  Reward out;
  double* value = out.terms.data();
  const double rewards = r.rewards.add_up(s, schedule, value);
  double* const first_penalty = value;
  const double penalties = r.penalties.add_up(s, schedule, value);
  const double weight = r.penalty.weight * schedule.penalty;
  for (double* term = first_penalty; term != value; ++term) *term *= -weight;
  double* const first_unbounded = value;
  const double unbounded = r.unbounded_penalties.add_up(s, schedule, value);
  for (double* term = first_unbounded; term != value; ++term) *term *= -1.0;
  const double sum = bounded(rewards - weight * penalties, schedule.late * r.floor);
  out.value = static_cast<float>(r.scale * (sum - unbounded));
  return out;
}

}  // namespace sandrunner::train
