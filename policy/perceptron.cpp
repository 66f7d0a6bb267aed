// SPDX-License-Identifier: BSD-3-Clause
#include "policy/perceptron.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <utility>

#include "policy/activations.h"
#include "policy/packed_layer.h"

namespace sandrunner {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
/// Rows of a panel, and what the inputs of a layer are padded to: the most chains of a sum.
constexpr int kPanelRows = 64;
constexpr int kMostChains = 8;
constexpr int kWidestInput =
    std::max(ObservationLayout::kMostInputs, PerceptronParameters::kWidest);

constexpr int padded(int count, int to) { return (count + to - 1) / to * to; }

/// Rows of the panel that begins at `row`: a power of two times the lanes, so that it has whole
/// chains.
constexpr int panel_rows(int outputs, int row) {
  int rows = kPackedLanes;
  while (rows < kPanelRows && rows < outputs - row) rows *= 2;
  return rows;
}

/// A layer in the order in which a step reads it: see PackedLayer.
struct Layer {
  int inputs = 0, outputs = 0;  ///< inputs padded
  std::size_t begin = 0;        ///< of its weights
};

void apply(Activation activation, float* values, int count) noexcept {
  switch (activation) {
    case Activation::kElu:
      for (int i = 0; i < count; ++i) values[i] = elu(values[i]);
      return;
    case Activation::kRelu:
      for (int i = 0; i < count; ++i) values[i] = values[i] < 0.0f ? 0.0f : values[i];
      return;
    case Activation::kLeakyRelu:
      for (int i = 0; i < count; ++i) values[i] = leaky_relu(values[i]);
      return;
    case Activation::kTanh:
      for (int i = 0; i < count; ++i) values[i] = tanh_approximation(values[i]);
      return;
  }
}

/// Memory on cache lines.
struct AlignedDelete {
  void operator()(float* memory) const noexcept { ::operator delete(memory, std::align_val_t{64}); }
};

}  // namespace

int PerceptronParameters::actor_inputs() const {
  return estimator.empty() ? observation.inputs() : observation.numbers() + estimator.back();
}

struct Perceptron::Packed {
  ObservationLayout observation;
  Activation activation = Activation::kElu;
  JointArray<int> joint_of{};
  JointArray<float> nominal_rad{};  ///< in the network's order
  float action_clip = 0.0f;
  int interval = 1;  ///< steps at kPolicyHz between two answers
  double period_s = 0.0;
  float velocity_scale = 1.0f;
  int numbers = 0, all_numbers = 0;  ///< of one observation, of all that it sees
  std::vector<Layer> estimator, actor;
  std::size_t size = 0;  ///< of the weights
  std::unique_ptr<float, AlignedDelete> weights;

  void add(const std::vector<DenseParameters>& layers, std::vector<Layer>& packed);
  void fill(const std::vector<DenseParameters>& layers, const std::vector<Layer>& packed);
  void run(const std::vector<Layer>& layers, float* values) const noexcept;
};

void Perceptron::Packed::add(const std::vector<DenseParameters>& layers,
                             std::vector<Layer>& packed) {
  for (const DenseParameters& layer : layers) {
    const auto outputs = static_cast<int>(layer.bias.size());
    const int inputs = padded(static_cast<int>(layer.weight.size()) / outputs, kMostChains);
    packed.push_back({inputs, outputs, size});
    for (int row = 0; row < outputs; row += kPanelRows) {
      const auto columns = 1 + static_cast<std::size_t>(inputs);
      size += columns * static_cast<std::size_t>(panel_rows(outputs, row));
    }
  }
}

void Perceptron::Packed::fill(const std::vector<DenseParameters>& layers,
                              const std::vector<Layer>& packed) {
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const std::size_t columns = layers[k].weight.size() / layers[k].bias.size();
    float* at = weights.get() + packed[k].begin;
    for (int row = 0; row < packed[k].outputs; row += kPanelRows) {
      const int rows = panel_rows(packed[k].outputs, row);
      const int used = std::min(rows, packed[k].outputs - row);
      for (int lane = 0; lane < used; ++lane) {
        const std::size_t r = static_cast<std::size_t>(row) + static_cast<std::size_t>(lane);
        at[lane] = layers[k].bias[r];
        for (std::size_t j = 0; j < columns; ++j) {
          at[(1 + j) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(lane)] =
              layers[k].weight[r * columns + j];
        }
      }
      at += rows * (1 + packed[k].inputs);
    }
  }
}

/// `values`: input and output; what is behind them counts as zeros and is overwritten.
void Perceptron::Packed::run(const std::vector<Layer>& layers, float* values) const noexcept {
  alignas(64) float other[kWidestInput];
  float* input = values;
  float* output = other;
  for (const Layer& layer : layers) {
    const float* at = weights.get() + layer.begin;
    for (int row = 0; row < layer.outputs; row += kPanelRows) {
      const int rows = panel_rows(layer.outputs, row);
      switch (rows / kPackedLanes) {
        case 8:
          multiply_rows<8, 1>(at, layer.inputs, input, output + row);
          break;
        case 4:
          multiply_rows<4, 2>(at, layer.inputs, input, output + row);
          break;
        case 2:
          multiply_rows<2, 4>(at, layer.inputs, input, output + row);
          break;
        default:
          multiply_rows<1, 8>(at, layer.inputs, input, output + row);
      }
      at += rows * (1 + layer.inputs);
    }
    const int end = padded(layer.outputs, kMostChains);
    std::fill(output + layer.outputs, output + end, 0.0f);
    if (&layer != &layers.back()) apply(activation, output, layer.outputs);
    std::swap(input, output);
  }
  if (input != values) std::copy_n(input, layers.back().outputs, values);
}

Perceptron::Perceptron(const PerceptronParameters& parameters,
                       const JointArray<double>& nominal_rad, double action_clip) {
  const auto packed = std::make_shared<Packed>();
  Packed& p = *packed;
  p.observation = parameters.observation;
  p.activation = parameters.activation;
  p.joint_of = parameters.joint_of;
  for (int j = 0; j < kNumJoints; ++j) {
    p.nominal_rad[j] = static_cast<float>(nominal_rad[parameters.joint_of[j]]);
  }
  p.action_clip = static_cast<float>(action_clip);
  p.interval = kPolicyHz / parameters.policy_hz;
  p.period_s = 1.0 / parameters.policy_hz;
  p.velocity_scale = static_cast<float>(parameters.velocity_scale);
  p.numbers = p.observation.numbers();
  p.all_numbers = p.observation.inputs();
  p.add(parameters.estimator_layers, p.estimator);
  p.add(parameters.actor_layers, p.actor);
  const std::size_t bytes = p.size * sizeof(float);
  p.weights.reset(static_cast<float*>(::operator new(bytes, std::align_val_t{64})));
  std::fill_n(p.weights.get(), p.size, 0.0f);
  p.fill(parameters.estimator_layers, p.estimator);
  p.fill(parameters.actor_layers, p.actor);
  packed_ = packed;
}

void Perceptron::answer(const float* input, JointArray<float>& action,
                        std::array<float, 3>& velocity_mps) const noexcept {
  const Packed& p = *packed_;
  alignas(64) float values[kWidestInput + kMostChains] = {};
  std::copy_n(input, p.all_numbers, values);
  velocity_mps.fill(kNone);
  if (!p.estimator.empty()) {
    p.run(p.estimator, values);
    constexpr int kVelocity = PerceptronParameters::kVelocitySize;
    const int size = p.estimator.back().outputs;
    float square = 0.0f;
    for (int i = kVelocity; i < size; ++i) square = fma(values[i], values[i], square);
    const float norm = std::sqrt(square);
    const float divisor = norm < 1e-12f ? 1e-12f : norm;
    for (int i = 0; i < kVelocity; ++i) {
      velocity_mps[static_cast<std::size_t>(i)] = values[i] / p.velocity_scale;
    }
    for (int i = kVelocity; i < size; ++i) values[i] /= divisor;
    std::copy_backward(values, values + size, values + p.numbers + size);
    std::copy_n(input, p.numbers, values);  // the newest observation
    const int end = p.numbers + size;
    std::fill(values + end, values + padded(end, kMostChains), 0.0f);
  }
  p.run(p.actor, values);
  std::copy_n(values, kNumJoints, action.begin());
}

void Perceptron::step(const std::array<float, kObservationSize>& observation, NetworkState& state,
                      NetworkOutput& output) const noexcept {
  const Packed& p = *packed_;
  PerceptronPast& past = state.perceptron;
  const std::uint64_t step = past.steps++;
  if (step % static_cast<std::uint64_t>(p.interval) == 0) {
    JointArray<float> position{}, velocity{};
    for (int j = 0; j < kNumJoints; ++j) {
      const auto joint = static_cast<std::size_t>(p.joint_of[j]);
      position[j] = observation[9 + joint] - p.nominal_rad[j];
      velocity[j] = observation[9 + kNumJoints + joint];
    }
    const std::uint64_t answers = step / static_cast<std::uint64_t>(p.interval);
    const JointArray<float> last_action = past.last_action;
    float* const seen = past.observations.data();
    std::copy_backward(seen, seen + p.all_numbers - p.numbers, seen + p.all_numbers);
    write_observation(
        p.observation,
        {observation, position, velocity, last_action, static_cast<double>(answers) * p.period_s},
        seen);
    for (int k = 1; step == 0 && k < p.observation.history; ++k) {
      std::copy_n(seen, p.numbers, seen + k * p.numbers);
    }
    float input[ObservationLayout::kMostInputs];
    arrange(p.observation, seen, input);
    answer(input, past.last_action, past.velocity_mps);
    if (p.action_clip > 0.0f) {
      for (float& action : past.last_action) action = clip(action, p.action_clip);
    }
  }
  for (int j = 0; j < kNumJoints; ++j) {
    output.action[static_cast<std::size_t>(p.joint_of[j])] = past.last_action[j];
  }
  output.estimate_raw.fill(kNone);
  std::copy_n(past.velocity_mps.begin(), 3, output.estimate_raw.begin() + 1);
}

void Perceptron::touch_weights() const noexcept {
  touch_lines(packed_->weights.get(), weight_bytes());
}

std::size_t Perceptron::weight_bytes() const noexcept { return packed_->size * sizeof(float); }

}  // namespace sandrunner
