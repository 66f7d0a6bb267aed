// SPDX-License-Identifier: BSD-3-Clause
// How the networks of a policy are wired. The paper's are the defaults; the others are those that
// its study compares with them.
#pragma once

#include <array>
#include <string>

#include "rt/core/messages.h"

namespace sandrunner {

/// What no robot can sense, but a network of a study may see: the parameters of the ground under
/// the base, ...
inline constexpr int kTerrainSize = 10;
/// ... and all that a teacher sees: [terrain | estimate without error | load of each foot].
inline constexpr int kInsightSize = kTerrainSize + kEstimateSize + kNumLegs;

/// Of the three layers of EncoderKind::kTcn: taps of each, and steps between them.
inline constexpr int kTcnTaps = 5;
inline constexpr std::array<int, 3> kTcnDilations = {1, 3, 9};
/// Steps before the present one that it sees.
inline constexpr int kTcnPast =
    (kTcnTaps - 1) * (kTcnDilations[0] + kTcnDilations[1] + kTcnDilations[2]);

/// How the observations become the encoding, which estimator and actor see.
enum class EncoderKind {
  kLstm,     ///< recurrent, of the proprioception
  kTcn,      ///< convolutions over time, of the proprioception
  kInsight,  ///< a teacher's: an MLP of the insight, which a robot cannot sense
};

/// What the actor sees behind the command, in this order. Its gradient goes into the encoding
/// alone.
struct ActorInputs {
  bool encoding = true;
  bool estimate = true;
  bool proprioception = false;
  bool terrain = false;  ///< the first kTerrainSize numbers of the insight

  bool operator==(const ActorInputs&) const = default;
};

struct Wiring {
  EncoderKind encoder = EncoderKind::kLstm;
  ActorInputs actor_sees;

  bool operator==(const Wiring&) const = default;
  /// A network sees what a robot cannot sense.
  bool sees_insight() const { return encoder == EncoderKind::kInsight || actor_sees.terrain; }
};

/// Wiring as policy files and the table `network` of a training's settings have it: the name of an
/// encoder, and the parts that the actor sees with commas between. Throw InputError, which names
/// `key`.
EncoderKind parse_encoder(const std::string& key, const std::string& text);
ActorInputs parse_actor_inputs(const std::string& key, const std::string& text);
/// The way back.
std::string encoder_text(EncoderKind encoder);
std::string actor_inputs_text(const ActorInputs& actor);

/// "encoder NAME, actor sees PART, PART".
std::string wiring_text(const Wiring& wiring);

}  // namespace sandrunner
