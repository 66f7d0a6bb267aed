// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/evidence/grid_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace sandrunner::study {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

const std::vector<const char*>& grid_controllers() {
  static const std::vector<const char*> kKeys = {"ours",       "env-rigid", "pl-gm",    "pl-rigid",
                                                 "teacher-gm", "oracle-h",  "oracle-o", "tcn"};
  return kKeys;
}

Slopes fit_slopes(const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<double>& y) {
  double n = 0.0, mean_a = 0.0, mean_b = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (std::isnan(y[i])) continue;
    n += 1.0;
    mean_a += a[i];
    mean_b += b[i];
  }
  mean_a /= n;
  mean_b /= n;
  double aa = 0.0, bb = 0.0, ab = 0.0, ay = 0.0, by = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (std::isnan(y[i])) continue;
    const double da = a[i] - mean_a, db = b[i] - mean_b;
    aa += da * da;
    bb += db * db;
    ab += da * db;
    ay += da * y[i];
    by += db * y[i];
  }
  const double determinant = aa * bb - ab * ab;
  // Also without a point, as nan.
  if (!(determinant > 1e-9 * aa * bb)) return {kNan, kNan};
  return {(ay * bb - by * ab) / determinant, (by * aa - ay * ab) / determinant};
}

const std::vector<double>& grid_list(const Measured& measured, const char* name) {
  return measured.select(kGridGround, kGridCells).at(0)->lists.at(name);
}

std::vector<double> grid_medians(const Evidence& evidence, const char* controller,
                                 const char* name) {
  std::vector<double> medians;
  const auto* seeds = evidence.find("E7", controller);
  if (seeds == nullptr) return medians;
  const std::size_t cells = grid_list(seeds->begin()->second, name).size();
  for (std::size_t cell = 0; cell < cells; ++cell) {
    std::vector<double> values;
    for (const auto& [seed, measured] : *seeds) {
      const double value = grid_list(measured, name)[cell];
      if (!std::isnan(value)) values.push_back(value);
    }
    medians.push_back(values.empty() ? kNan : median_of(values));
  }
  return medians;
}

Figure grid_figure(const Evidence& evidence, const char* controller, const char* name) {
  return evidence.figure("E7", controller, [&](const Measured& m) {
    return mean_value(m.select(kGridGround, kGridRobots), name);
  });
}

SoftAndStiff soft_and_stiff(const Measured& measured, const char* name) {
  const std::vector<double>&depth = grid_list(measured, "static_depth_m"),
        &value = grid_list(measured, name);
  std::vector<std::size_t> order(depth.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return depth[i] > depth[j]; });
  const std::size_t quarter = order.size() / 4;
  std::vector<double> soft, stiff;
  for (std::size_t i = 0; i < quarter; ++i) {
    soft.push_back(value[order[i]]);
    stiff.push_back(value[order[order.size() - 1 - i]]);
  }
  return {mean_of(soft), mean_of(stiff)};
}

}  // namespace sandrunner::study
