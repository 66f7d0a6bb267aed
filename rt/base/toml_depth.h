// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace sandrunner {

/// More than any key or value of ours has.
inline constexpr std::size_t kMostKeyParts = 32, kMostNestedValues = 32;
/// toml++ reads some MB a second; a file of settings has some kB.
inline constexpr std::size_t kMostTomlBytes = std::size_t{1} << 20;

/// Where TOML text is nested too deep for the stack.
struct TomlDepth {
  std::size_t line = 0;  ///< of the first such place, from 1; 0: nowhere
  const char* problem = nullptr;
};

/// To be asked before toml++ parses: it recurses over nested values, to a depth of 256, and over
/// the tables that a dotted key makes, without a limit, when they are destroyed.
TomlDepth find_too_deep(std::string_view toml) noexcept;

}  // namespace sandrunner
