// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string_view>

namespace sandrunner {

/// Writes to the standard error; one that nobody takes any more (a terminal that hung up, a full
/// disk) is no error of the program. fmt::print throws there, which would end a run half-way.
inline void to_standard_error(std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace sandrunner
