// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace sandrunner::study {

/// y = a e^(b x) + c x + d. The paper prints "ae^{bx} + cx + b", with b twice.
struct CotCurve {
  double a = 0.0, b = 0.0, c = 0.0, d = 0.0;

  double at(double x) const;
};

/// The curve with the least squares: b by a search in [-3, 3], the others by linear least squares.
/// Points that are not finite are left out; nothing with fewer than five.
std::optional<CotCurve> fit_cot_curve(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace sandrunner::study
