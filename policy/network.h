// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "policy/network_parameters.h"
#include "policy/observation_layout.h"
#include "rt/core/state_hash.h"

namespace sandrunner {

/// The last inputs of a convolution over time, as many as its taps reach: that of step k at k %
/// kSteps.
template <int kInputs, int kDilation>
struct TcnLayerPast {
  static constexpr int kSteps = (kTcnTaps - 1) * kDilation + 1;
  std::array<std::array<float, kInputs>, kSteps> input{};
};

/// What a TCN remembers.
struct TcnPast {
  std::uint64_t steps = 0;  ///< since the start
  TcnLayerPast<kEncoderInputSize, kTcnDilations[0]> layer_0;
  TcnLayerPast<kTcnChannels, kTcnDilations[1]> layer_1;
  TcnLayerPast<kTcnChannels, kTcnDilations[2]> layer_2;
};

/// What a network of others remembers (perceptron.h).
struct PerceptronPast {
  std::uint64_t steps = 0;              ///< at kPolicyHz, since the start
  JointArray<float> last_action{};      ///< in its own order, limited
  std::array<float, 3> velocity_mps{};  ///< of its estimator
  float unused = 0.0f;                  ///< no padding
  /// That it sees, the newest first.
  std::array<float, ObservationLayout::kMostInputs> observations{};
};

/// What the network remembers from step to step. All zero at the start.
struct NetworkState {
  std::array<float, kHiddenSize> h{};  ///< the encoder's output
  std::array<float, kHiddenSize> c{};  ///< cells of an LSTM
  TcnPast past;                        ///< last: an LSTM leaves both as they are
  PerceptronPast perceptron;
};
static_assert(std::is_trivially_copyable_v<NetworkState>);
static_assert(sizeof(NetworkState) ==
              offsetof(NetworkState, past) + sizeof(TcnPast) + sizeof(PerceptronPast));

/// Adds what the network has remembered.
inline void add_to(StateHash& hash, const NetworkState& state) noexcept {
  hash.add(state.h);
  hash.add(state.c);
  if (state.past.steps > 0) hash.add(state.past);
  if (state.perceptron.steps > 0) hash.add(state.perceptron);
}

/// What one step of the network yields, before any scaling.
struct NetworkOutput {
  std::array<float, kNumJoints> action{};
  std::array<float, kEstimateSize> estimate_raw{};
};

/// The whole network: normalisation; encoder, LSTM (paper, "Controller structure") or TCN, 30 ->
/// 64; estimator 64-128-128-8; actor 75-256-128-12, or wider where it sees the proprioception.
/// Leaky ReLU on the hidden layers, linear outputs. Batch of one.
///
/// The result has the same bits from every compiler and optimisation level: each row of each layer
/// is a fixed chain of fused multiply-adds. Copies share the weights, which never change.
class Network {
 public:
  /// Packs the parameters, for which require_runnable() holds, as for those of a file that
  /// load_policy takes. It is not checked here.
  explicit Network(const NetworkParameters& parameters);

  /// One step. `observation` is raw, i.e. not normalised. Real-time safe. A NaN in the observation
  /// reaches every output and stays in `state` until that is cleared (of a TCN: for 53 steps).
  void step(const std::array<float, kObservationSize>& observation, NetworkState& state,
            NetworkOutput& output) const noexcept;

  /// Reads every cache line of the weights, so that the next step finds them in the core's caches.
  /// Real-time safe.
  void touch_weights() const noexcept;

  /// Bytes that a step reads of its weights, as packed.
  std::size_t weight_bytes() const noexcept;

 private:
  struct PackedWeights;
  std::shared_ptr<const PackedWeights> weights_;
};

}  // namespace sandrunner
