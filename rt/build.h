// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// What this program was built from and with: version, commit, compiler. Records of a run carry it.
std::string build_name();

}  // namespace sandrunner
