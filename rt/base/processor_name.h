// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// The processor's model as Linux names it, which each measured figure goes with; "unknown" where
/// it does not.
std::string processor_name();

}  // namespace sandrunner
