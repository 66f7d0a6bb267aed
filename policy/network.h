// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "policy/network_parameters.h"

namespace sandrunner {

/// What the network remembers from step to step: output and cell of the LSTM. All zero at the
/// start.
struct NetworkState {
  std::array<float, kHiddenSize> h{};
  std::array<float, kHiddenSize> c{};
};
static_assert(std::is_trivially_copyable_v<NetworkState>);

/// What one step of the network yields, before any scaling.
struct NetworkOutput {
  std::array<float, kNumJoints> action{};
  std::array<float, kEstimateSize> estimate_raw{};
};

/// The whole network (paper, "Controller structure"): normalisation, LSTM encoder 30 -> 64,
/// estimator 64-128-128-8, actor 75-256-128-12, leaky ReLU on the hidden layers, linear outputs.
/// Batch of one.
///
/// The result has the same bits from every compiler and optimisation level: each row of each layer
/// is a fixed chain of fused multiply-adds. Copies share the weights, which never change.
class Network {
 public:
  /// Packs the parameters. Throws InputError if a tensor does not have its size.
  explicit Network(const NetworkParameters& parameters);

  /// One step. `observation` is raw, i.e. not normalised. Real-time safe. A NaN in the observation
  /// reaches every output and stays in `state` until that is cleared.
  void step(const std::array<float, kObservationSize>& observation, NetworkState& state,
            NetworkOutput& output) const noexcept;

  /// Reads every cache line of the weights, so that the next step finds them in the core's caches.
  /// Real-time safe.
  void touch_weights() const noexcept;

  /// Bytes that a step reads of its weights, as packed.
  static std::size_t weight_bytes() noexcept;

 private:
  struct PackedWeights;
  std::shared_ptr<const PackedWeights> weights_;
};

}  // namespace sandrunner
