// SPDX-License-Identifier: BSD-3-Clause
// Exact t-distributed stochastic neighbour embedding (van der Maaten & Hinton 2008) into the plane.
#pragma once

#include <Eigen/Core>

namespace sandrunner::study {

struct TsneSettings {
  double perplexity = 30.0;
  int iterations = 1000;
  double exaggeration = 12.0;  ///< of the attraction, in the first `exaggerated` iterations
  int exaggerated = 250;
  double rate = 50.0;
};

using Points = Eigen::ArrayXXd;  ///< a row each

/// Symmetric joint probabilities of the points; every conditional distribution has the perplexity.
Eigen::ArrayXXd joint_probabilities(const Points& points, double perplexity);

/// The gradient of the Kullback-Leibler divergence at the embedding `y` (two columns), the
/// attraction times `exaggeration`.
Points tsne_gradient(const Eigen::ArrayXXd& joint, const Points& y, double exaggeration);

/// The divergence itself.
double tsne_divergence(const Eigen::ArrayXXd& joint, const Points& y);

/// The embedding, two columns, from the first two principal components. No random numbers.
Points tsne(const Points& points, const TsneSettings& settings);

}  // namespace sandrunner::study
