// SPDX-License-Identifier: BSD-3-Clause
// How the networks are wired. A robot's are wired in one way; the others are of networks that only
// a study needs.
#pragma once

#include <array>
#include <string>

namespace sandrunner::learner {

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
  kInsight,  ///< a teacher's: an MLP of what a robot cannot measure (BasicRollout::insight)
};

/// What the actor sees behind the command, in this order. Its gradient goes into the encoding
/// alone.
struct ActorInputs {
  bool encoding = true;
  bool estimate = true;
  bool proprioception = false;
  bool terrain = false;  ///< the first kTerrainSize rows of BasicRollout::insight
};

/// Wiring as the table `network` of a training's settings has it: the name of an encoder, and the
/// parts that the actor sees with commas between. Throw InputError, which names `key`.
EncoderKind parse_encoder(const std::string& key, const std::string& text);
ActorInputs parse_actor_inputs(const std::string& key, const std::string& text);

/// "encoder NAME, actor sees PART, PART".
std::string wiring_text(EncoderKind encoder, const ActorInputs& actor);

}  // namespace sandrunner::learner
