// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "policy/activations.h"
#include "policy/network.h"
#include "policy/packed_layer.h"

namespace sandrunner {

/// The LSTM, its weights packed.
class LstmEncoder {
 public:
  void pack(const NetworkParameters& parameters);
  /// `proprioception`: the normalised observation without the command.
  void step(const float* proprioception, NetworkState& state) const noexcept;

 private:
  static constexpr int kGates = 4;
  static constexpr int kColumns = kEncoderInputSize + kHiddenSize;
  using Layer = PackedLayer<kColumns, kGates * kHiddenSize>;
  /// A panel holds all four gates of its units, so that they are finished while they are hot.
  static constexpr int kUnits = Layer::kRows / kGates;

  Layer layer_;
};

/// Columns are the input, then h. The two biases are one.
inline void LstmEncoder::pack(const NetworkParameters& parameters) {
  for (int gate = 0; gate < kGates; ++gate) {
    for (int unit = 0; unit < kHiddenSize; ++unit) {
      const int row = gate * kHiddenSize + unit;
      auto& panel = layer_.panel[unit / kUnits];
      const int lane = gate * kUnits + unit % kUnits;
      panel[0][lane] = parameters.encoder_bias_ih[row] + parameters.encoder_bias_hh[row];
      for (int j = 0; j < kEncoderInputSize; ++j) {
        panel[1 + j][lane] = parameters.encoder_weight_ih[row * kEncoderInputSize + j];
      }
      for (int j = 0; j < kHiddenSize; ++j) {
        panel[1 + kEncoderInputSize + j][lane] =
            parameters.encoder_weight_hh[row * kHiddenSize + j];
      }
    }
  }
}

inline void LstmEncoder::step(const float* proprioception, NetworkState& state) const noexcept {
  alignas(64) float input[kColumns];
  std::copy_n(proprioception, kEncoderInputSize, input);
  std::copy_n(state.h.data(), kHiddenSize, input + kEncoderInputSize);
  alignas(64) float gates[kGates][kUnits];
  for (int p = 0; p < Layer::kPanels; ++p) {
    multiply_panel(layer_, p, input, gates[0]);
    float* const h = state.h.data() + p * kUnits;
    float* const c = state.c.data() + p * kUnits;
    for (int u = 0; u < kUnits; ++u) {
      const float in = sigmoid(gates[0][u]) * tanh_approximation(gates[2][u]);
      c[u] = fma(sigmoid(gates[1][u]), c[u], in);
      h[u] = sigmoid(gates[3][u]) * tanh_approximation(c[u]);
    }
  }
}

}  // namespace sandrunner
