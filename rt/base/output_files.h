// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sandrunner {

/// Makes the folder if need be. Throws InputError, which names `option`, if nothing can be written
/// there: now rather than after the run.
void prepare_folder(const std::string& folder, const std::string& option);

/// Writes `text` to a file beside `path` and renames it: whole or absent. InputError if it cannot.
void write_text(const std::string& text, const std::string& path);

}  // namespace sandrunner
