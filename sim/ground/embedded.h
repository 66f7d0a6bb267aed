// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// Terrain presets as built into the program ("dry-sand.toml"); empty for other names.
std::string_view embedded_terrain_file(std::string_view name) noexcept;

}  // namespace sandrunner
