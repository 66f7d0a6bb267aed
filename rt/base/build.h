// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// What this program was built from and with: version, commit, compiler. Records of a run carry it.
std::string build_name();

/// The commit alone, followed by "-dirty" if files differed from it when CMake configured, which it
/// does after every commit; empty outside of a repository.
std::string build_commit();

}  // namespace sandrunner
