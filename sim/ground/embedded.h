// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sandrunner {

/// Terrain presets as built into the program ("dry-sand.toml"); empty for other names.
std::string_view embedded_terrain_file(std::string_view name) noexcept;
/// The names of all of them, sorted.
std::vector<std::string> embedded_terrain_file_names();

}  // namespace sandrunner
