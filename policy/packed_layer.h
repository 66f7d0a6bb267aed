// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "policy/activations.h"
#include "policy/eight_floats.h"
#include "policy/network_parameters.h"

namespace sandrunner {

inline constexpr int kPackedLanes = 8;  // of EightFloats

/// Reads each cache line. Real-time safe.
inline void touch_lines(const void* memory, std::size_t bytes) noexcept {
  const auto* at = static_cast<const volatile char*>(memory);
  for (std::size_t i = 0; i < bytes; i += 64) static_cast<void>(at[i]);  // volatile: is read
}

/// A layer's weights in the order in which `multiply_panel` reads them, so that a step is one
/// forward stream through memory: panels of up to 64 rows; in each the bias, then one column after
/// the other.
///
/// A panel is summed in eight registers (40 rows: five), which hide the latency of the fused
/// multiply-add. Narrow layers have fewer rows than that: there `kChains` sums share the columns
/// (column j goes to sum j mod kChains).
template <int kInputs, int kOutputs>
struct PackedLayer {
  static constexpr int kVectors = std::min(8, (kOutputs + kPackedLanes - 1) / kPackedLanes);
  static constexpr int kChains = 8 / kVectors;
  static constexpr int kRows = kVectors * kPackedLanes;
  static constexpr int kPanels = (kOutputs + kRows - 1) / kRows;
  static constexpr int kPaddedOutputs = kPanels * kRows;
  static_assert(kInputs % kChains == 0);

  alignas(64) float panel[kPanels][1 + kInputs][kRows];
};

/// `result` (kVectors x 8 rows) = one panel at `weight` times `input`, of whose numbers there are a
/// multiple of kChains.
template <int kVectors, int kChains>
inline void multiply_rows(const float* weight, int inputs, const float* input,
                          float* result) noexcept {
  constexpr int kRows = kVectors * kPackedLanes;
  EightFloats sum[kChains][kVectors];
  for (int chain = 0; chain < kChains; ++chain) {
    for (int v = 0; v < kVectors; ++v) {
      sum[chain][v] = chain == 0 ? load_eight(weight + v * kPackedLanes) : eight_times(0.0f);
    }
  }
  weight += kRows;
  for (int column = 0; column < inputs; column += kChains) {
    for (int chain = 0; chain < kChains; ++chain) {
      const EightFloats x = eight_times(input[column + chain]);
      for (int v = 0; v < kVectors; ++v) {
        sum[chain][v] = multiply_add(load_eight(weight + v * kPackedLanes), x, sum[chain][v]);
      }
      weight += kRows;
    }
  }
  for (int stride = kChains / 2; stride > 0; stride /= 2) {
    for (int chain = 0; chain < stride; ++chain) {
      for (int v = 0; v < kVectors; ++v) {
        sum[chain][v] = add(sum[chain][v], sum[chain + stride][v]);
      }
    }
  }
  for (int v = 0; v < kVectors; ++v) store_eight(result + v * kPackedLanes, sum[0][v]);
}

/// The same of one panel of a layer.
template <int kInputs, int kOutputs>
inline void multiply_panel(const PackedLayer<kInputs, kOutputs>& layer, int index,
                           const float* input, float* result) noexcept {
  using Layer = PackedLayer<kInputs, kOutputs>;
  multiply_rows<Layer::kVectors, Layer::kChains>(layer.panel[index][0], kInputs, input, result);
}

/// Output of a layer, padded to whole panels.
template <int kInputs, int kOutputs>
struct LayerOutput {
  alignas(64) float value[PackedLayer<kInputs, kOutputs>::kPaddedOutputs];
};

template <int kInputs, int kOutputs>
inline void linear(const PackedLayer<kInputs, kOutputs>& layer, const float* input,
                   LayerOutput<kInputs, kOutputs>& output) noexcept {
  using Layer = PackedLayer<kInputs, kOutputs>;
  for (int p = 0; p < Layer::kPanels; ++p) {
    multiply_panel(layer, p, input, output.value + p * Layer::kRows);
  }
}

template <int kInputs, int kOutputs>
inline void linear_leaky_relu(const PackedLayer<kInputs, kOutputs>& layer, const float* input,
                              LayerOutput<kInputs, kOutputs>& output) noexcept {
  linear(layer, input, output);
  for (float& value : output.value) value = leaky_relu(value);
}

template <int kInputs, int kOutputs>
void pack(const DenseParameters& parameters, PackedLayer<kInputs, kOutputs>& layer) {
  using Layer = PackedLayer<kInputs, kOutputs>;
  for (int row = 0; row < kOutputs; ++row) {
    auto& panel = layer.panel[row / Layer::kRows];
    const int lane = row % Layer::kRows;
    panel[0][lane] = parameters.bias[row];
    for (int j = 0; j < kInputs; ++j) panel[1 + j][lane] = parameters.weight[row * kInputs + j];
  }
}

}  // namespace sandrunner
