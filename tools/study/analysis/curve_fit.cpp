// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/analysis/curve_fit.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sandrunner::study {

double CotCurve::at(double x) const { return a * std::exp(b * x) + c * x + d; }

std::optional<CotCurve> fit_cot_curve(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t kLeast = 5;
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i])) used.push_back(i);
  }
  if (used.size() < kLeast) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd terms(n, 3);
  Eigen::VectorXd values(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    terms(i, 1) = x[used[static_cast<std::size_t>(i)]];
    terms(i, 2) = 1.0;
    values(i) = y[used[static_cast<std::size_t>(i)]];
  }
  CotCurve best;
  double least = std::numeric_limits<double>::infinity();
  const auto attempt = [&](double b) {
    terms.col(0) = (b * terms.col(1)).array().exp();
    const Eigen::Vector3d found = terms.colPivHouseholderQr().solve(values);
    const double error = (terms * found - values).squaredNorm();
    if (error < least) {
      least = error;
      best = {found(0), b, found(1), found(2)};
    }
  };
  // On a grid that leaves out 0, where the exponential is no term of its own; then ever finer
  // around the best.
  constexpr double kMost = 3.0;
  for (int i = -30; i <= 30; ++i) {
    if (i != 0) attempt(kMost * i / 30.0);
  }
  for (double step = 0.05; step > 1e-4; step *= 0.5) {
    const double middle = best.b;
    for (const double b : {middle - step, middle + step}) {
      if (std::fabs(b) <= kMost && std::fabs(b) > 0.02) attempt(b);
    }
  }
  return best;
}

}  // namespace sandrunner::study
