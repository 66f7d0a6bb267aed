// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "policy/activations.h"
#include "policy/network.h"
#include "policy/packed_layer.h"

namespace sandrunner {

/// Three causal convolutions over time and a dense layer with tanh, their weights packed. What a
/// layer has read is kept in TcnPast, so that a step computes each layer once. A tap before the
/// first step reads zero.
class TcnEncoder {
 public:
  void pack(const NetworkParameters& parameters);
  /// `proprioception`: the normalised observation without the command.
  void step(const float* proprioception, NetworkState& state) const noexcept;

 private:
  template <int kInputs>
  using Convolution = PackedLayer<kTcnTaps * kInputs, kTcnChannels>;
  template <int kInputs>
  using Output = LayerOutput<kTcnTaps * kInputs, kTcnChannels>;

  /// Puts `input` into the layer's past at this step and reads that at its taps.
  template <int kInputs, int kDilation>
  static void convolve(const Convolution<kInputs>& layer, std::uint64_t step, const float* input,
                       TcnLayerPast<kInputs, kDilation>& past, Output<kInputs>& output) noexcept;

  Convolution<kEncoderInputSize> layer_0_;
  Convolution<kTcnChannels> layer_1_;
  Convolution<kTcnChannels> layer_2_;
  PackedLayer<kTcnChannels, kHiddenSize> dense_;
};

inline void TcnEncoder::pack(const NetworkParameters& parameters) {
  sandrunner::pack(parameters.encoder[0], layer_0_);
  sandrunner::pack(parameters.encoder[1], layer_1_);
  sandrunner::pack(parameters.encoder[2], layer_2_);
  sandrunner::pack(parameters.encoder[3], dense_);
}

template <int kInputs, int kDilation>
void TcnEncoder::convolve(const Convolution<kInputs>& layer, std::uint64_t step, const float* input,
                          TcnLayerPast<kInputs, kDilation>& past,
                          Output<kInputs>& output) noexcept {
  constexpr std::size_t kSteps = TcnLayerPast<kInputs, kDilation>::kSteps;
  std::copy_n(input, kInputs, past.input[step % kSteps].begin());
  alignas(64) float taps[kTcnTaps * kInputs];
  for (std::size_t tap = 0; tap < kTcnTaps; ++tap) {
    const std::size_t at = (step + kSteps - tap * kDilation) % kSteps;
    std::copy_n(past.input[at].begin(), kInputs, taps + tap * kInputs);
  }
  linear_leaky_relu(layer, taps, output);
}

inline void TcnEncoder::step(const float* proprioception, NetworkState& state) const noexcept {
  TcnPast& past = state.past;
  Output<kEncoderInputSize> output_0;
  Output<kTcnChannels> output_1, output_2;
  convolve(layer_0_, past.steps, proprioception, past.layer_0, output_0);
  convolve(layer_1_, past.steps, output_0.value, past.layer_1, output_1);
  convolve(layer_2_, past.steps, output_1.value, past.layer_2, output_2);
  LayerOutput<kTcnChannels, kHiddenSize> encoding;
  linear(dense_, output_2.value, encoding);
  for (int i = 0; i < kHiddenSize; ++i) state.h[i] = tanh_approximation(encoding.value[i]);
  ++past.steps;
}

}  // namespace sandrunner
