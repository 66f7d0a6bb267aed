// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/eigen_network.h"

#include <algorithm>

#include "policy/activations.h"

namespace sandrunner::bench {
namespace {

using Eigen::MatrixXf;
using Eigen::VectorXf;

VectorXf vector(const std::vector<float>& values) {
  return VectorXf::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

MatrixXf matrix(const std::vector<float>& values, Eigen::Index rows) {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return RowMajor::Map(values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows);
}

}  // namespace

EigenNetwork::EigenNetwork(const NetworkParameters& parameters)
    : mean_(vector(parameters.observation_mean)),
      deviation_((vector(parameters.observation_variance).array() + 1e-8f).sqrt()),
      clip_(parameters.observation_clip),
      weight_ih_(matrix(parameters.encoder_weight_ih, 4 * kHiddenSize)),
      weight_hh_(matrix(parameters.encoder_weight_hh, 4 * kHiddenSize)),
      bias_(vector(parameters.encoder_bias_ih) + vector(parameters.encoder_bias_hh)),
      gates_(4 * kHiddenSize),
      h_(VectorXf::Zero(kHiddenSize)),
      c_(VectorXf::Zero(kHiddenSize)),
      normalised_(kObservationSize),
      encoder_input_(kEncoderInputSize),
      actor_input_(kActorSizes[0]) {
  for (int k = 0; k < 3; ++k) {
    estimator_[k] = dense(parameters.estimator[k]);
    actor_[k] = dense(parameters.actor[k]);
  }
}

EigenNetwork::Dense EigenNetwork::dense(const DenseParameters& parameters) {
  const VectorXf bias = vector(parameters.bias);
  return {matrix(parameters.weight, bias.size()), bias, bias};
}

const VectorXf& EigenNetwork::Dense::linear(const VectorXf& input) {
  output = bias;
  output.noalias() += weight * input;
  return output;
}

const VectorXf& EigenNetwork::Dense::leaky_relu(const VectorXf& input) {
  linear(input);
  output = output.cwiseMax(kLeakyReluSlope * output);
  return output;
}

void EigenNetwork::step(const std::array<float, kObservationSize>& observation,
                        NetworkOutput& output) {
  const auto raw = VectorXf::Map(observation.data(), kObservationSize);
  normalised_ = ((raw - mean_).array() / deviation_.array()).max(-clip_).min(clip_);
  encoder_input_ = normalised_.tail(kEncoderInputSize);
  gates_ = bias_;
  gates_.noalias() += weight_ih_ * encoder_input_;
  gates_.noalias() += weight_hh_ * h_;
  const auto gate = [&](int k) { return gates_.segment(k * kHiddenSize, kHiddenSize).array(); };
  c_ = gate(1).logistic() * c_.array() + gate(0).logistic() * gate(2).tanh();
  h_ = gate(3).logistic() * c_.array().tanh();

  const VectorXf& estimate =
      estimator_[2].linear(estimator_[1].leaky_relu(estimator_[0].leaky_relu(h_)));
  actor_input_ << normalised_.head(kCommandSize), h_, estimate;
  const VectorXf& action =
      actor_[2].linear(actor_[1].leaky_relu(actor_[0].leaky_relu(actor_input_)));
  std::copy_n(estimate.data(), kEstimateSize, output.estimate_raw.begin());
  std::copy_n(action.data(), kNumJoints, output.action.begin());
}

}  // namespace sandrunner::bench
