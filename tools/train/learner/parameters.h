// SPDX-License-Identifier: BSD-3-Clause
// All weights of all networks lie in one flat array; this is its map. Gradients and Adam's moments
// have the same shape, which makes the reduction over blocks, the gradient norm, the optimiser and
// the checkpoint plain loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "policy/network_parameters.h"
#include "policy/wiring.h"
#include "rt/core/messages.h"
#include "tools/train/data/rollout.h"

namespace sandrunner::learner {

/// Observation = [command | proprioception]; the encoder sees the second part, the actor also the
/// first.
inline constexpr int kProprioceptionSize = kObservationSize - kCommandSize;
inline constexpr int kActionSize = kNumJoints;

/// Widths of the hidden layers, and how the networks are wired; the defaults are the paper's
/// (critic: ours, the paper does not give it).
struct NetworkSizes {
  int hidden = 64;  ///< size of the encoding
  std::vector<int> estimator = {128, 128};
  std::vector<int> actor = {256, 128};
  std::vector<int> critic = {256, 128};
  Wiring wiring = {};
  std::vector<int> insight = {kInsightHidden};  ///< hidden layers of EncoderKind::kInsight

  int channels = kTcnChannels;  ///< of each layer of EncoderKind::kTcn
};

/// A tensor within the flat array: row-major, starting at `offset`.
struct TensorView {
  std::string name;
  int rows = 0;
  int cols = 0;
  std::ptrdiff_t offset = 0;
};

/// One layer of an MLP: y = W x + b, W (outputs x inputs) row-major.
struct LayerView {
  int inputs = 0;
  int outputs = 0;
  std::ptrdiff_t weight = 0;  ///< offset of W
  std::ptrdiff_t bias = 0;    ///< offset of b
};

class ParameterLayout {
 public:
  /// `privileged`: size of the critic's input.
  ParameterLayout(const NetworkSizes& sizes, int privileged);

  std::ptrdiff_t size() const { return size_; }
  const std::vector<TensorView>& tensors() const { return tensors_; }
  const NetworkSizes& sizes() const { return sizes_; }
  int hidden() const { return sizes_.hidden; }
  int privileged() const { return privileged_; }
  /// Rows of what the encoder remembers from one step to the next: h and c of an LSTM, past
  /// observations and the number of those that count of a TCN.
  int memory() const;
  /// Rows of what the actor sees.
  int actor_inputs() const;

  /// LSTM as one matrix [W_ih | bias | W_hh], (4 hidden) x (30 + 1 + hidden), rows in gate order i,
  /// f, g, o.
  std::ptrdiff_t encoder() const { return encoder_; }
  /// The layers of an encoder of another kind.
  const std::vector<LayerView>& encoder_layers() const { return encoder_layers_; }
  const std::vector<LayerView>& estimator() const { return estimator_; }
  const std::vector<LayerView>& actor() const { return actor_; }
  const std::vector<LayerView>& critic() const { return critic_; }
  /// Logarithms of the 12 standard deviations of the actions.
  std::ptrdiff_t log_std() const { return log_std_; }

 private:
  void add_encoder();
  std::ptrdiff_t add(std::string name, int rows, int cols);
  std::vector<LayerView> add_mlp(const std::string& name, int inputs,
                                 const std::vector<int>& hidden, int outputs);
  void add_layer(const std::string& name, int inputs, int outputs, std::vector<LayerView>& layers);

  NetworkSizes sizes_;
  int privileged_;
  std::ptrdiff_t size_ = 0;
  std::vector<TensorView> tensors_;
  std::ptrdiff_t encoder_ = 0;
  std::vector<LayerView> encoder_layers_;
  std::vector<LayerView> estimator_;
  std::vector<LayerView> actor_;
  std::vector<LayerView> critic_;
  std::ptrdiff_t log_std_;
};

/// Random start: Gaussian weights scaled by the number of inputs, zero biases, forget-gate bias 1,
/// last layer of the actor x 0.05 and of the critic x 0.3, all standard deviations of the actions
/// `action_std`.
std::vector<float> initial_parameters(const ParameterLayout& layout, std::uint64_t seed,
                                      double action_std);

/// Encoder, estimator and actor into those of a policy file, with their wiring. (`bias_hh` gets
/// zeros: one bias is enough.) Its normalisation stays.
void to_policy(const ParameterLayout& layout, const std::vector<float>& parameters,
               NetworkParameters& policy);
/// The way back. Critic and noise stay.
void from_policy(const NetworkParameters& policy, const ParameterLayout& layout,
                 std::vector<float>& parameters);

}  // namespace sandrunner::learner
