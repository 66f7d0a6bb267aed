// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace sandrunner {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace sandrunner
