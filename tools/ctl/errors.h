// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace sandrunner::ctl {

/// Exit code of sandrunner-ctl when the robot refused, or none answered.
inline constexpr int kExitRefused = 1;

/// The robot refused, or none answered: `what()` is one line that says which.
class RefusedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sandrunner::ctl
