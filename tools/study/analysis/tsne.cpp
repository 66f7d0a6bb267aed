// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/analysis/tsne.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace sandrunner::study {
namespace {

Eigen::ArrayXXd squared_distances(const Points& points) {
  const Eigen::Index n = points.rows();
  Eigen::ArrayXXd d(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    d.col(i) = (points.rowwise() - points.row(i)).square().rowwise().sum();
  }
  return d;
}

// The first two principal components, with a deviation of 1e-4.
Points start_of(const Points& points) {
  constexpr double kDeviation = 1e-4;
  const Eigen::MatrixXd centred = (points.rowwise() - points.colwise().mean()).matrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centred.transpose() * centred);
  Points y = (centred * solver.eigenvectors().rightCols(2).rowwise().reverse()).array();
  const double variance = y.col(0).square().mean();
  if (variance > 0.0) y *= kDeviation / std::sqrt(variance);
  return y;
}

// 1/(1 + d^2) to all points; 0 to itself.
Eigen::ArrayXd kernel(const Points& y, Eigen::Index i) {
  Eigen::ArrayXd q =
      (1.0 + (y.col(0) - y(i, 0)).square() + (y.col(1) - y(i, 1)).square()).inverse();
  q(i) = 0.0;
  return q;
}

}  // namespace

Eigen::ArrayXXd joint_probabilities(const Points& points, double perplexity) {
  const Eigen::Index n = points.rows();
  const Eigen::ArrayXXd d = squared_distances(points);
  Eigen::ArrayXXd conditional(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    // The precision at which the entropy is that of the perplexity, by bisection.
    const double wanted = std::log(perplexity);
    double low = 0.0, high = std::numeric_limits<double>::infinity(), precision = 1.0;
    Eigen::ArrayXd away = d.col(i), p;
    away(i) = std::numeric_limits<double>::infinity();
    away -= away.minCoeff();
    for (int step = 0; step < 100; ++step) {
      p = (-precision * away).exp();
      p(i) = 0.0;
      p /= p.sum();
      const double entropy = -(p > 0.0).select(p * p.max(1e-300).log(), 0.0).sum();
      if (std::fabs(entropy - wanted) < 1e-7) break;
      (entropy > wanted ? low : high) = precision;
      precision = std::isinf(high) ? 2.0 * precision : 0.5 * (low + high);
    }
    conditional.col(i) = p;
  }
  return (conditional + conditional.transpose()) / (2.0 * static_cast<double>(n));
}

Points tsne_gradient(const Eigen::ArrayXXd& joint, const Points& y, double exaggeration) {
  const Eigen::Index n = y.rows();
  Points attraction(n, 2), repulsion(n, 2);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::ArrayXd q = kernel(y, i);
    sum += q.sum();
    const Eigen::ArrayXd pull = joint.col(i) * q, push = q * q;
    for (int k = 0; k < 2; ++k) {
      const Eigen::ArrayXd apart = y(i, k) - y.col(k);
      attraction(i, k) = (pull * apart).sum();
      repulsion(i, k) = (push * apart).sum();
    }
  }
  return 4.0 * (exaggeration * attraction - repulsion / sum);
}

double tsne_divergence(const Eigen::ArrayXXd& joint, const Points& y) {
  const Eigen::Index n = y.rows();
  Eigen::ArrayXXd q(n, n);
  for (Eigen::Index i = 0; i < n; ++i) q.col(i) = kernel(y, i);
  q /= q.sum();
  return (joint > 0.0).select(joint * (joint.max(1e-300) / q.max(1e-300)).log(), 0.0).sum();
}

Points tsne(const Points& points, const TsneSettings& settings) {
  constexpr double kSlowMomentum = 0.5, kFastMomentum = 0.8;
  const Eigen::ArrayXXd joint = joint_probabilities(points, settings.perplexity);
  Points y = start_of(points);
  Points velocity = Points::Zero(y.rows(), 2);
  for (int step = 0; step < settings.iterations; ++step) {
    const bool early = step < settings.exaggerated;
    const Points gradient = tsne_gradient(joint, y, early ? settings.exaggeration : 1.0);
    velocity = (early ? kSlowMomentum : kFastMomentum) * velocity - settings.rate * gradient;
    y += velocity;
    y.rowwise() -= y.colwise().mean().eval();
  }
  return y;
}

}  // namespace sandrunner::study
