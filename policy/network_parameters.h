// SPDX-License-Identifier: BSD-3-Clause
// The network's numbers as a trainer and a file hold them: plain row-major tensors. `Network` packs
// them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "policy/named_tensors.h"
#include "policy/wiring.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// The encoder sees the observation without its command.
inline constexpr int kEncoderInputSize = kObservationSize - kCommandSize;
inline constexpr int kHiddenSize = 64;
/// Input, two hidden layers, output (paper, "Controller structure").
inline constexpr std::array<int, 4> kEstimatorSizes = {kHiddenSize, 128, 128, kEstimateSize};
/// The actor's input is the normalised command, the encoder's output and the raw estimate, in this
/// order; that of another wiring: `actor_sizes`.
inline constexpr std::array<int, 4> kActorSizes = {kCommandSize + kHiddenSize + kEstimateSize, 256,
                                                   128, kNumJoints};
/// Width of the three convolutions of EncoderKind::kTcn, and of the hidden layer of kInsight.
inline constexpr int kTcnChannels = 40;
inline constexpr int kInsightHidden = 72;

/// All parameters of the network, in PyTorch's layout. The LSTM's gates are stacked in the order
/// input, forget, cell, output; both of its biases are added. A convolution's weight is (outputs,
/// taps * inputs), the present step first. Shapes: `tensors_of`.
struct NetworkParameters {
  Wiring wiring;
  std::vector<float> encoder_weight_ih;
  std::vector<float> encoder_weight_hh;
  std::vector<float> encoder_bias_ih;
  std::vector<float> encoder_bias_hh;
  std::vector<DenseParameters> encoder;  ///< layers of one that is no LSTM
  std::array<DenseParameters, 3> estimator;
  std::array<DenseParameters, 3> actor;
  /// Observations enter as (x - mean) / sqrt(variance + 1e-8), limited to +-observation_clip.
  std::vector<float> observation_mean;
  std::vector<float> observation_variance;
  float observation_clip = 10.0f;
};

/// kActorSizes with the input of this wiring.
std::array<int, 4> actor_sizes(const ActorInputs& sees);

/// The tensors that the wiring of `parameters` has, in the order of the computation; the pointers
/// live as long as `parameters`.
std::vector<NamedTensor> tensors_of(NetworkParameters& parameters);

/// Throws InputError unless a Network can be made of them: every tensor has its size, and the
/// wiring sees no insight.
void require_runnable(const NetworkParameters& parameters);

}  // namespace sandrunner
