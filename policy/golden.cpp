// SPDX-License-Identifier: BSD-3-Clause
#include "policy/golden.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "rt/core/split_mix.h"

namespace sandrunner {
namespace {

using Doubles = std::vector<double>;

/// weight (outputs, inputs) row-major times input, plus bias.
Doubles linear(const std::vector<float>& weight, const std::vector<float>& bias,
               const Doubles& input) {
  Doubles output(bias.begin(), bias.end());
  for (std::size_t row = 0; row < output.size(); ++row) {
    for (std::size_t j = 0; j < input.size(); ++j) {
      output[row] += static_cast<double>(weight[row * input.size() + j]) * input[j];
    }
  }
  return output;
}

void leaky_relu(Doubles& values) {
  for (double& value : values) value = value > 0.0 ? value : 0.01 * value;
}

Doubles perceptron(std::span<const DenseParameters> layers, Doubles values) {
  for (const DenseParameters& layer : layers) {
    if (&layer != layers.data()) leaky_relu(values);
    values = linear(layer.weight, layer.bias, values);
  }
  return values;
}

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// The network again, written as plainly as possible: the definition that `Network` is checked
/// against.
class PlainNetwork {
 public:
  explicit PlainNetwork(const NetworkParameters& parameters) : parameters_(parameters) {}

  struct Output {
    Doubles action;
    Doubles estimate_raw;
  };

  /// `insight` counts only if a network sees it.
  Output step(const float* observation, const float* insight) {
    const NetworkParameters& p = parameters_;
    Doubles input;
    for (int i = 0; i < kObservationSize; ++i) {
      const double deviation = std::sqrt(static_cast<double>(p.observation_variance[i]) + 1e-8);
      const double x = (static_cast<double>(observation[i]) - p.observation_mean[i]) / deviation;
      const double limit = p.observation_clip;
      input.push_back(std::clamp(x, -limit, limit));
    }
    const Doubles proprioception(input.begin() + kCommandSize, input.end());
    const Doubles encoding = encode(proprioception, insight);
    const Doubles estimate_raw = perceptron(p.estimator, encoding);
    const ActorInputs& sees = p.wiring.actor_sees;
    Doubles actor_input(input.begin(), input.begin() + kCommandSize);
    const auto add = [&](bool seen, const auto& values) {
      if (seen) actor_input.insert(actor_input.end(), values.begin(), values.end());
    };
    add(sees.encoding, encoding);
    add(sees.estimate, estimate_raw);
    add(sees.proprioception, proprioception);
    if (sees.terrain) add(true, std::span(insight, kTerrainSize));
    return {perceptron(p.actor, actor_input), estimate_raw};
  }

 private:
  Doubles encode(const Doubles& proprioception, const float* insight) {
    switch (parameters_.wiring.encoder) {
      case EncoderKind::kTcn:
        return convolve(proprioception);
      case EncoderKind::kInsight:
        return hyperbolic_tangent(
            perceptron(parameters_.encoder, Doubles(insight, insight + kInsightSize)));
      case EncoderKind::kLstm:
        break;
    }
    return remember(proprioception);
  }

  static Doubles hyperbolic_tangent(Doubles values) {
    for (double& value : values) value = std::tanh(value);
    return values;
  }

  /// Each layer reads the one below it now and at its taps; before the first step, that is zero.
  Doubles convolve(Doubles values) {
    for (std::size_t i = 0; i < kTcnDilations.size(); ++i) {
      below_[i].push_back(values);
      Doubles taps;
      for (int tap = 0; tap < kTcnTaps; ++tap) {
        const std::ptrdiff_t at = std::ssize(below_[i]) - 1 - tap * kTcnDilations[i];
        const Doubles& read = at < 0 ? Doubles(values.size(), 0.0) : below_[i][at];
        taps.insert(taps.end(), read.begin(), read.end());
      }
      values = linear(parameters_.encoder[i].weight, parameters_.encoder[i].bias, taps);
      leaky_relu(values);
    }
    const DenseParameters& last = parameters_.encoder.back();
    return hyperbolic_tangent(linear(last.weight, last.bias, values));
  }

  /// The LSTM.
  Doubles remember(const Doubles& input) {
    const NetworkParameters& p = parameters_;
    const Doubles from_input = linear(p.encoder_weight_ih, p.encoder_bias_ih, input);
    const Doubles from_state = linear(p.encoder_weight_hh, p.encoder_bias_hh, h_);
    for (int u = 0; u < kHiddenSize; ++u) {
      const auto gate = [&](int k) {
        return from_input[k * kHiddenSize + u] + from_state[k * kHiddenSize + u];
      };
      c_[u] = logistic(gate(1)) * c_[u] + logistic(gate(0)) * std::tanh(gate(2));
      h_[u] = logistic(gate(3)) * std::tanh(c_[u]);
    }
    return h_;
  }

  const NetworkParameters& parameters_;
  Doubles h_ = Doubles(kHiddenSize, 0.0);
  Doubles c_ = Doubles(kHiddenSize, 0.0);
  std::array<std::vector<Doubles>, kTcnDilations.size()> below_;  // of each convolution, all steps
};

/// Uniform numbers in [-1, 1) by SplitMix64: the same on every machine.
class Uniform {
 public:
  double next() { return static_cast<double>(next_bits(state_) >> 11) * 0x1p-52 - 1.0; }

 private:
  std::uint64_t state_ = 0;
};

const float* insight_at(const GoldenExample& golden, int step) {
  return golden.insight.empty() ? nullptr : &golden.insight[step * kInsightSize];
}

/// `step`: of a network, from an observation and an insight to its output.
template <typename Step>
double worst(const std::string& file, const GoldenExample& golden, Step step) {
  double largest = 0.0;
  for (int k = 0; k < kGoldenSteps; ++k) {
    const auto output = step(&golden.observation[k * kObservationSize], insight_at(golden, k));
    largest =
        std::max({largest, golden_deviation(file, k, "action", output.action, golden.action),
                  golden_deviation(file, k, "estimate", output.estimate_raw, golden.estimate_raw)});
  }
  return largest;
}

}  // namespace

GoldenExample make_golden_example(const NetworkParameters& parameters) {
  GoldenExample golden;
  PlainNetwork network(parameters);
  Uniform uniform;
  for (int k = 0; k < kGoldenSteps; ++k) {
    for (int i = 0; i < kObservationSize; ++i) {
      const double deviation = std::sqrt(static_cast<double>(parameters.observation_variance[i]));
      // Of unit variance; in every fifth step one number lies beyond the clip.
      double x = std::sqrt(3.0) * uniform.next();
      if (k % 5 == 4 && i == k % kObservationSize) x *= 2.0 * parameters.observation_clip;
      golden.observation.push_back(
          static_cast<float>(parameters.observation_mean[i] + deviation * x));
    }
    for (int i = 0; parameters.wiring.sees_insight() && i < kInsightSize; ++i) {
      golden.insight.push_back(static_cast<float>(std::sqrt(3.0) * uniform.next()));
    }
    const auto output =
        network.step(&golden.observation[k * kObservationSize], insight_at(golden, k));
    golden.action.insert(golden.action.end(), output.action.begin(), output.action.end());
    golden.estimate_raw.insert(golden.estimate_raw.end(), output.estimate_raw.begin(),
                               output.estimate_raw.end());
  }
  return golden;
}

double check_golden_example(const std::string& file, const Network& network,
                            const GoldenExample& golden) {
  NetworkState state;
  return worst(file, golden, [&](const float* observation, const float*) {
    std::array<float, kObservationSize> input;
    std::copy_n(observation, kObservationSize, input.begin());
    NetworkOutput output;
    network.step(input, state, output);
    return output;
  });
}

double check_golden_example(const std::string& file, const NetworkParameters& parameters,
                            const GoldenExample& golden) {
  if (!parameters.wiring.sees_insight()) {
    return check_golden_example(file, Network(parameters), golden);
  }
  PlainNetwork network(parameters);
  return worst(file, golden, [&](const float* observation, const float* insight) {
    return network.step(observation, insight);
  });
}

}  // namespace sandrunner
