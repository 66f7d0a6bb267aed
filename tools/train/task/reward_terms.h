// SPDX-License-Identifier: BSD-3-Clause
// What a term of the reward is. A term is a struct with
//   kName      its table in training.toml, and its column in curve.csv,
//   members    its parameters, with a row each in kSettings,
//   value()    what it gives a step, weighted,
//   kTable     its table, if terms share one.
#pragma once

#include <cstddef>

#include "tools/train/task/settings.h"
#include "tools/train/task/step_outcome.h"

namespace sandrunner::train {

/// Factors that change during the training. The defaults are those of a term that does not change.
struct RewardSchedule {
  double penalty = 1.0;  ///< of all penalties that the floor bounds
  double late = 0.0;     ///< 0 to 1: how much of the late penalties is on
  double prior = 0.0;    ///< 1 to exactly 0: of the rewards that fade

  /// 1, and `late_factor` when the late penalties are fully on.
  double grown(double late_factor) const { return 1.0 + (late_factor - 1.0) * late; }
};

/// Terms whose values are added up in this order. A part may be a Sum: its own sum is added. It
/// holds the parameters of a term as `sum.Term::parameter`.
template <typename... Parts>
struct Sum : Parts... {
  template <typename Part>
  static constexpr std::size_t terms_in() {
    if constexpr (requires { Part::kTerms; }) {
      return Part::kTerms;
    } else {
      return 1;
    }
  }
  static constexpr std::size_t kTerms = (terms_in<Parts>() + ...);

  /// Calls `visit` with each term, in order.
  template <typename Visit>
  void for_each(const Visit& visit) {
    const auto each = [&]<typename Part>(Part& part) {
      if constexpr (requires { Part::kTerms; }) {
        part.for_each(visit);
      } else {
        visit(part);
      }
    };
    (each(static_cast<Parts&>(*this)), ...);
  }

  /// The sum for a step. Writes the value of each term to `values`, and moves it past them.
  double add_up(const StepOutcome& s, const RewardSchedule& schedule, double*& values) const {
    double sum = 0.0;
    const auto add = [&]<typename Part>(const Part& part) {
      if constexpr (requires { Part::kTerms; }) {
        sum += part.add_up(s, schedule, values);
      } else {
        sum += * values++ = part.value(s, schedule);
      }
    };
    (add(static_cast<const Parts&>(*this)), ...);
    return sum;
  }
};

}  // namespace sandrunner::train
