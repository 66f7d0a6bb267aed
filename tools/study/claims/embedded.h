// SPDX-License-Identifier: BSD-3-Clause
// The file of this folder that is built into the program: CLAIMS.md.
#pragma once

#include <string_view>

namespace sandrunner {

/// The content of the file, empty for another name.
std::string_view study_files(std::string_view file_name) noexcept;

}  // namespace sandrunner
