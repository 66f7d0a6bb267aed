// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/messages.h"

namespace sandrunner {

/// The same value for every joint.
inline JointArray<double> all_joints(double value) {
  JointArray<double> all;
  all.fill(value);
  return all;
}

}  // namespace sandrunner
