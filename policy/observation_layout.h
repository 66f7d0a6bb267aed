// SPDX-License-Identifier: BSD-3-Clause
// What a network of others sees, as a list of terms. A new term is cases in
// observation_layout.cpp and a row in observation_text.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner {

enum class TermKind {
  kAngularVelocity,  ///< of the base, body frame, rad/s
  kGravity,          ///< direction of gravity in the body frame: 0, 0, -1 upright
  kCommand,          ///< vx, vy (m/s), yaw rate (rad/s)
  kJointPosition,    ///< less the nominal position, rad
  kJointVelocity,    ///< rad/s
  kLastAction,       ///< the network's answer before, limited; 0 at the start
  kPhase,            ///< sine and cosine of a clock that starts at 0
};

struct ObservationTerm {
  TermKind kind = TermKind::kCommand;
  std::vector<double> scale;  ///< of each number; empty: 1
  double clip = 0.0;          ///< limit of a number before its scale; 0: none
  double period_s = 0.0;      ///< of the phase
};

/// Where the steps before the present one stand in the network's input.
enum class HistoryOrder {
  kNewestFirst,  ///< whole observations
  kOldestFirst,
  kByTerm,  ///< all steps of the first term, the oldest first; then of the second, ...
};

struct ObservationLayout {
  /// Of one observation, and of all that a network sees.
  static constexpr int kMostNumbers = 64, kMostInputs = 1024;

  std::vector<ObservationTerm> terms;
  double clip = 0.0;  ///< limit of a number after its scale; 0: none
  int history = 1;    ///< observations that the network sees, the present one among them
  HistoryOrder order = HistoryOrder::kNewestFirst;

  /// Numbers of one observation, and of all.
  int numbers() const;
  int inputs() const { return history * numbers(); }
};

/// Numbers of a term of this kind.
int term_size(TermKind kind);

/// Terms as a file has them: "angular_velocity scale 0.25, gravity, command scale 2 2 0.25,
/// phase period 0.8". Throws InputError, which begins with `where`.
std::vector<ObservationTerm> parse_terms(const std::string& where, const std::string& text);
std::string terms_text(const std::vector<ObservationTerm>& terms);
HistoryOrder parse_history_order(const std::string& where, const std::string& text);
std::string history_order_text(HistoryOrder order);

/// What the terms are made of. Joints in the network's order.
struct TermInputs {
  const std::array<float, kObservationSize>& observation;  ///< of make_observation
  const JointArray<float>& position_rad;                   ///< less the nominal position
  const JointArray<float>& velocity_radps;
  const JointArray<float>& last_action;
  double time_s = 0.0;  ///< since the start
};

/// Writes the numbers of one observation. Real-time safe; NaN stays NaN.
void write_observation(const ObservationLayout& layout, const TermInputs& in,
                       float* numbers) noexcept;
/// The network's input from as many observations as it sees, the newest first. Real-time safe.
void arrange(const ObservationLayout& layout, const float* newest_first, float* input) noexcept;

}  // namespace sandrunner
