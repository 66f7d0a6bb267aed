// SPDX-License-Identifier: BSD-3-Clause
#include "policy/network.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>
#include <variant>

#include "policy/activations.h"
#include "policy/lstm_encoder.h"
#include "policy/packed_layer.h"
#include "policy/tcn_encoder.h"

namespace sandrunner {
namespace {

/// The actor's input: [command | encoding | estimate | proprioception]. The usual wiring sees all
/// but the last part.
constexpr int kEstimateAt = kCommandSize + kHiddenSize;
constexpr int kProprioceptionAt = kEstimateAt + kEstimateSize;
constexpr int kWidestActor = kProprioceptionAt + kEncoderInputSize;
static_assert(kActorSizes[0] == kProprioceptionAt);

/// The actor's first layer with a weight of zero for what it does not see.
DenseParameters widened(const DenseParameters& layer, const ActorInputs& sees) {
  DenseParameters wide{{}, layer.bias};
  const float* from = layer.weight.data();
  for (std::size_t row = 0; row < layer.bias.size(); ++row) {
    const auto add = [&](bool seen, int count) {
      wide.weight.insert(wide.weight.end(), static_cast<std::size_t>(count), 0.0f);
      if (!seen) return;
      std::copy_n(from, count, wide.weight.end() - count);
      from += count;
    };
    add(true, kCommandSize);
    add(sees.encoding, kHiddenSize);
    add(sees.estimate, kEstimateSize);
    add(sees.proprioception, kEncoderInputSize);
  }
  return wide;
}

/// Where the system grants it, one such page holds all weights: a cold step walks no page tables
/// and takes up to a quarter less time.
constexpr std::size_t kHugePageBytes = 2 << 20;
constexpr std::align_val_t kHugePageAlignment{kHugePageBytes};

/// Memory of that size and alignment, on a huge page or on small ones for good. Small ones, into
/// which fork() and a lock split a huge one, the kernel would join while the policy thread reads.
void* allocate_huge_page() {
  void* const memory = ::operator new(kHugePageBytes, kHugePageAlignment);
#ifdef __linux__
  madvise(memory, kHugePageBytes, MADV_HUGEPAGE);
  *static_cast<volatile char*>(memory) = 0;
  madvise(memory, kHugePageBytes, MADV_NOHUGEPAGE);
#endif
  return memory;
}

struct alignas(64) StreamedWeights {
  float observation_mean[kObservationSize];
  float observation_deviation[kObservationSize];
  float observation_clip;
  std::variant<LstmEncoder, TcnEncoder> encoder;
  PackedLayer<kEstimatorSizes[0], kEstimatorSizes[1]> estimator_0;
  PackedLayer<kEstimatorSizes[1], kEstimatorSizes[2]> estimator_1;
  PackedLayer<kEstimatorSizes[2], kEstimatorSizes[3]> estimator_2;
  PackedLayer<kActorSizes[0], kActorSizes[1]> actor_0;
  PackedLayer<kActorSizes[1], kActorSizes[2]> actor_1;
  PackedLayer<kActorSizes[2], kActorSizes[3]> actor_2;
};

}  // namespace

/// One block of memory, in the order of the computation.
struct Network::PackedWeights {
  StreamedWeights streamed;
  /// In place of actor_0 where the actor's inputs are not the usual ones.
  bool is_wide = false;
  PackedLayer<kWidestActor, kActorSizes[1]> wide_actor_0;

  std::size_t bytes_read() const { return is_wide ? sizeof *this : sizeof streamed; }
};

Network::Network(const NetworkParameters& parameters) {
  const Wiring& wiring = parameters.wiring;
  static_assert(sizeof(PackedWeights) <= kHugePageBytes);
  const std::shared_ptr<PackedWeights> packed(
      new (allocate_huge_page()) PackedWeights(),  // value-initialised: padding is zero
      [](PackedWeights* memory) { ::operator delete(memory, kHugePageAlignment); });
  StreamedWeights& w = packed->streamed;
  for (int i = 0; i < kObservationSize; ++i) {
    w.observation_mean[i] = parameters.observation_mean[i];
    w.observation_deviation[i] = static_cast<float>(
        std::sqrt(static_cast<double>(parameters.observation_variance[i]) + 1e-8));
  }
  w.observation_clip = parameters.observation_clip;
  if (wiring.encoder == EncoderKind::kTcn) w.encoder.emplace<TcnEncoder>();
  std::visit([&](auto& encoder) { encoder.pack(parameters); }, w.encoder);
  pack(parameters.estimator[0], w.estimator_0);
  pack(parameters.estimator[1], w.estimator_1);
  pack(parameters.estimator[2], w.estimator_2);
  packed->is_wide = !(wiring.actor_sees == ActorInputs{});
  if (packed->is_wide) {
    pack(widened(parameters.actor[0], wiring.actor_sees), packed->wide_actor_0);
  } else {
    pack(parameters.actor[0], w.actor_0);
  }
  pack(parameters.actor[1], w.actor_1);
  pack(parameters.actor[2], w.actor_2);
  weights_ = packed;
}

void Network::step(const std::array<float, kObservationSize>& observation, NetworkState& state,
                   NetworkOutput& output) const noexcept {
  const StreamedWeights& w = weights_->streamed;
  alignas(64) float normalised[kObservationSize];
  for (int i = 0; i < kObservationSize; ++i) {
    normalised[i] = clip((observation[i] - w.observation_mean[i]) / w.observation_deviation[i],
                         w.observation_clip);
  }
  const float* const proprioception = normalised + kCommandSize;
  std::visit([&](const auto& encoder) { encoder.step(proprioception, state); }, w.encoder);

  alignas(64) float actor_input[kWidestActor];
  std::copy_n(normalised, kCommandSize, actor_input);
  std::copy_n(state.h.data(), kHiddenSize, actor_input + kCommandSize);
  std::copy_n(proprioception, kEncoderInputSize, actor_input + kProprioceptionAt);

  LayerOutput<kEstimatorSizes[0], kEstimatorSizes[1]> estimator_0;
  LayerOutput<kEstimatorSizes[1], kEstimatorSizes[2]> estimator_1;
  LayerOutput<kEstimatorSizes[2], kEstimatorSizes[3]> estimate;
  linear_leaky_relu(w.estimator_0, actor_input + kCommandSize, estimator_0);
  linear_leaky_relu(w.estimator_1, estimator_0.value, estimator_1);
  linear(w.estimator_2, estimator_1.value, estimate);
  std::copy_n(estimate.value, kEstimateSize, actor_input + kEstimateAt);
  std::copy_n(estimate.value, kEstimateSize, output.estimate_raw.begin());

  LayerOutput<kActorSizes[0], kActorSizes[1]> actor_0;
  LayerOutput<kActorSizes[1], kActorSizes[2]> actor_1;
  LayerOutput<kActorSizes[2], kActorSizes[3]> action;
  if (weights_->is_wide) {
    LayerOutput<kWidestActor, kActorSizes[1]> wide;
    linear_leaky_relu(weights_->wide_actor_0, actor_input, wide);
    std::copy_n(wide.value, kActorSizes[1], actor_0.value);
  } else {
    linear_leaky_relu(w.actor_0, actor_input, actor_0);
  }
  linear_leaky_relu(w.actor_1, actor_0.value, actor_1);
  linear(w.actor_2, actor_1.value, action);
  std::copy_n(action.value, kNumJoints, output.action.begin());
}

void Network::touch_weights() const noexcept { touch_lines(weights_.get(), weight_bytes()); }

std::size_t Network::weight_bytes() const noexcept { return weights_->bytes_read(); }

}  // namespace sandrunner
