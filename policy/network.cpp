// SPDX-License-Identifier: BSD-3-Clause
#include "policy/network.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>

#include "policy/activations.h"
#include "policy/packed_layer.h"
#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr int kGates = 4;
constexpr int kEncoderColumns = kEncoderInputSize + kHiddenSize;
using EncoderLayer = PackedLayer<kEncoderColumns, kGates * kHiddenSize>;
/// A panel of the encoder holds all four gates of its units, so that they are finished while they
/// are hot.
constexpr int kUnits = EncoderLayer::kRows / kGates;

/// Columns are the input, then h. The two biases are one.
void pack_encoder(const NetworkParameters& parameters, EncoderLayer& layer) {
  for (int gate = 0; gate < kGates; ++gate) {
    for (int unit = 0; unit < kHiddenSize; ++unit) {
      const int row = gate * kHiddenSize + unit;
      auto& panel = layer.panel[unit / kUnits];
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

/// `input` (kEncoderColumns) is the observation without the command, then h of the last step.
inline void encode(const EncoderLayer& layer, const float* input, NetworkState& state) noexcept {
  alignas(64) float gates[kGates][kUnits];
  for (int p = 0; p < EncoderLayer::kPanels; ++p) {
    multiply_panel(layer, p, input, gates[0]);
    float* const h = state.h.data() + p * kUnits;
    float* const c = state.c.data() + p * kUnits;
    for (int u = 0; u < kUnits; ++u) {
      const float in = sigmoid(gates[0][u]) * tanh_approximation(gates[2][u]);
      c[u] = std::fma(sigmoid(gates[1][u]), c[u], in);
      h[u] = sigmoid(gates[3][u]) * tanh_approximation(c[u]);
    }
  }
}

/// Where the system grants it, one such page holds all weights: a cold step walks no page tables
/// and takes up to a quarter less time.
constexpr std::size_t kHugePageBytes = 2 << 20;
constexpr std::align_val_t kHugePageAlignment{kHugePageBytes};

/// Memory of that size and alignment, on a huge page or on small ones for good. Small ones, into
/// which fork() and a lock split a huge one, the kernel would join while the policy thread reads.
void* allocate_huge_page() {
  void* const memory = ::operator new(kHugePageBytes, kHugePageAlignment);
  madvise(memory, kHugePageBytes, MADV_HUGEPAGE);
  *static_cast<volatile char*>(memory) = 0;
  madvise(memory, kHugePageBytes, MADV_NOHUGEPAGE);
  return memory;
}

void check_sizes(const NetworkParameters& parameters) {
  NetworkParameters copy = parameters;
  for (const NamedTensor& tensor : tensors_of(copy)) {
    if (tensor.values->size() != tensor.size()) {
      throw InputError(fmt::format("network: tensor '{}' has {} values, expected {}", tensor.name,
                                   tensor.values->size(), tensor.size()));
    }
  }
}

}  // namespace

/// One block of memory, in the order of the computation.
struct alignas(64) Network::PackedWeights {
  float observation_mean[kObservationSize];
  float observation_deviation[kObservationSize];
  float observation_clip;
  EncoderLayer encoder;
  PackedLayer<kEstimatorSizes[0], kEstimatorSizes[1]> estimator_0;
  PackedLayer<kEstimatorSizes[1], kEstimatorSizes[2]> estimator_1;
  PackedLayer<kEstimatorSizes[2], kEstimatorSizes[3]> estimator_2;
  PackedLayer<kActorSizes[0], kActorSizes[1]> actor_0;
  PackedLayer<kActorSizes[1], kActorSizes[2]> actor_1;
  PackedLayer<kActorSizes[2], kActorSizes[3]> actor_2;
};

Network::Network(const NetworkParameters& parameters) {
  if (!(parameters.wiring == Wiring{})) {
    throw InputError(fmt::format("network: found networks wired as '{}', expected '{}'",
                                 wiring_text(parameters.wiring), wiring_text({})));
  }
  check_sizes(parameters);
  static_assert(sizeof(PackedWeights) <= kHugePageBytes);
  const std::shared_ptr<PackedWeights> weights(
      new (allocate_huge_page()) PackedWeights(),  // value-initialised: padding is zero
      [](PackedWeights* packed) { ::operator delete(packed, kHugePageAlignment); });
  for (int i = 0; i < kObservationSize; ++i) {
    weights->observation_mean[i] = parameters.observation_mean[i];
    weights->observation_deviation[i] = static_cast<float>(
        std::sqrt(static_cast<double>(parameters.observation_variance[i]) + 1e-8));
  }
  weights->observation_clip = parameters.observation_clip;
  pack_encoder(parameters, weights->encoder);
  pack(parameters.estimator[0], weights->estimator_0);
  pack(parameters.estimator[1], weights->estimator_1);
  pack(parameters.estimator[2], weights->estimator_2);
  pack(parameters.actor[0], weights->actor_0);
  pack(parameters.actor[1], weights->actor_1);
  pack(parameters.actor[2], weights->actor_2);
  weights_ = weights;
}

void Network::step(const std::array<float, kObservationSize>& observation, NetworkState& state,
                   NetworkOutput& output) const noexcept {
  const PackedWeights& w = *weights_;
  alignas(64) float normalised[kObservationSize];
  for (int i = 0; i < kObservationSize; ++i) {
    normalised[i] = clip((observation[i] - w.observation_mean[i]) / w.observation_deviation[i],
                         w.observation_clip);
  }
  alignas(64) float encoder_input[kEncoderColumns];
  std::copy_n(normalised + kCommandSize, kEncoderInputSize, encoder_input);
  std::copy_n(state.h.data(), kHiddenSize, encoder_input + kEncoderInputSize);
  encode(w.encoder, encoder_input, state);

  alignas(64) float actor_input[kActorSizes[0]];
  std::copy_n(normalised, kCommandSize, actor_input);
  std::copy_n(state.h.data(), kHiddenSize, actor_input + kCommandSize);

  LayerOutput<kEstimatorSizes[0], kEstimatorSizes[1]> estimator_0;
  LayerOutput<kEstimatorSizes[1], kEstimatorSizes[2]> estimator_1;
  LayerOutput<kEstimatorSizes[2], kEstimatorSizes[3]> estimate;
  linear_leaky_relu(w.estimator_0, actor_input + kCommandSize, estimator_0);
  linear_leaky_relu(w.estimator_1, estimator_0.value, estimator_1);
  linear(w.estimator_2, estimator_1.value, estimate);
  std::copy_n(estimate.value, kEstimateSize, actor_input + kCommandSize + kHiddenSize);
  std::copy_n(estimate.value, kEstimateSize, output.estimate_raw.begin());

  LayerOutput<kActorSizes[0], kActorSizes[1]> actor_0;
  LayerOutput<kActorSizes[1], kActorSizes[2]> actor_1;
  LayerOutput<kActorSizes[2], kActorSizes[3]> action;
  linear_leaky_relu(w.actor_0, actor_input, actor_0);
  linear_leaky_relu(w.actor_1, actor_0.value, actor_1);
  linear(w.actor_2, actor_1.value, action);
  std::copy_n(action.value, kNumJoints, output.action.begin());
}

void Network::touch_weights() const noexcept {
  const auto* at = reinterpret_cast<const volatile float*>(weights_.get());
  constexpr std::size_t kLine = 64 / sizeof(float);
  for (std::size_t i = 0; i < sizeof(PackedWeights) / sizeof(float); i += kLine) {
    static_cast<void>(at[i]);  // volatile: is read
  }
}

std::size_t Network::weight_bytes() noexcept { return sizeof(PackedWeights); }

}  // namespace sandrunner
