// SPDX-License-Identifier: BSD-3-Clause
#include "policy/observation_layout.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "policy/activations.h"

namespace sandrunner {
namespace {

/// Sine of 2 pi x, of a turn: an odd polynomial on a quarter, folded; error below 1e-7.
double sine_of_turn(double x) noexcept {
  double t = x - std::floor(x + 0.5);  // -0.5 to 0.5
  if (t > 0.25) t = 0.5 - t;
  if (t < -0.25) t = -0.5 - t;
  const double a = 6.283185307179586 * t, s = a * a;
  double p = 1.0 / 6227020800.0;
  p = fma(p, s, -1.0 / 39916800.0);
  p = fma(p, s, 1.0 / 362880.0);
  p = fma(p, s, -1.0 / 5040.0);
  p = fma(p, s, 1.0 / 120.0);
  p = fma(p, s, -1.0 / 6.0);
  return fma(p * s, a, a);
}

float number_of_term(const ObservationTerm& term, const TermInputs& in, int i) noexcept {
  const auto at = static_cast<std::size_t>(i);
  switch (term.kind) {
    case TermKind::kAngularVelocity:
      return in.observation[6 + at];
    case TermKind::kGravity:
      return -in.observation[3 + at];
    case TermKind::kCommand:
      return in.observation[at];
    case TermKind::kJointPosition:
      return in.position_rad[at];
    case TermKind::kJointVelocity:
      return in.velocity_radps[at];
    case TermKind::kLastAction:
      return in.last_action[at];
    case TermKind::kPhase:
      break;
  }
  return static_cast<float>(sine_of_turn(in.time_s / term.period_s + (i == 0 ? 0.0 : 0.25)));
}

}  // namespace

int ObservationLayout::numbers() const {
  int sum = 0;
  for (const ObservationTerm& term : terms) sum += term_size(term.kind);
  return sum;
}

int term_size(TermKind kind) {
  switch (kind) {
    case TermKind::kAngularVelocity:
    case TermKind::kGravity:
    case TermKind::kCommand:
      return 3;
    case TermKind::kJointPosition:
    case TermKind::kJointVelocity:
    case TermKind::kLastAction:
      return kNumJoints;
    case TermKind::kPhase:
      break;
  }
  return 2;
}

void write_observation(const ObservationLayout& layout, const TermInputs& in,
                       float* numbers) noexcept {
  for (const ObservationTerm& term : layout.terms) {
    const int size = term_size(term.kind);
    for (int i = 0; i < size; ++i, ++numbers) {
      const float value = number_of_term(term, in, i);
      const float limited = term.clip > 0.0 ? clip(value, static_cast<float>(term.clip)) : value;
      const std::size_t at = term.scale.size() == 1 ? 0 : static_cast<std::size_t>(i);
      const float scaled =
          term.scale.empty() ? limited : limited * static_cast<float>(term.scale[at]);
      *numbers = layout.clip > 0.0 ? clip(scaled, static_cast<float>(layout.clip)) : scaled;
    }
  }
}

void arrange(const ObservationLayout& layout, const float* newest_first, float* input) noexcept {
  const int numbers = layout.numbers();
  if (layout.order == HistoryOrder::kNewestFirst) {
    std::copy_n(newest_first, layout.inputs(), input);
    return;
  }
  // Blocks of a whole observation or of one term, each from the oldest step to the newest.
  int begin = 0;
  const auto add_block = [&](int size) {
    for (int step = layout.history - 1; step >= 0; --step, input += size) {
      std::copy_n(newest_first + step * numbers + begin, size, input);
    }
    begin += size;
  };
  if (layout.order == HistoryOrder::kOldestFirst) return add_block(numbers);
  for (const ObservationTerm& term : layout.terms) add_block(term_size(term.kind));
}

}  // namespace sandrunner
