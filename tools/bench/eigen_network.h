// SPDX-License-Identifier: BSD-3-Clause
// The network as one writes it with Eigen's matrices of dynamic size: what `Network` is timed
// against.
#pragma once

#include <Eigen/Dense>

#include "policy/network.h"

namespace sandrunner::bench {

class EigenNetwork {
 public:
  explicit EigenNetwork(const NetworkParameters& parameters);

  void step(const std::array<float, kObservationSize>& observation, NetworkOutput& output);

 private:
  struct Dense {
    Eigen::MatrixXf weight;
    Eigen::VectorXf bias, output;

    const Eigen::VectorXf& linear(const Eigen::VectorXf& input);
    const Eigen::VectorXf& leaky_relu(const Eigen::VectorXf& input);
  };
  static Dense dense(const DenseParameters& parameters);

  Eigen::VectorXf mean_, deviation_;
  float clip_;
  Eigen::MatrixXf weight_ih_, weight_hh_;
  Eigen::VectorXf bias_, gates_, h_, c_, normalised_, encoder_input_, actor_input_;
  std::array<Dense, 3> estimator_, actor_;
};

}  // namespace sandrunner::bench
