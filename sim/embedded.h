// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// Robot files and terrain presets as built into the program ("raibo.urdf", "dry-sand.toml"); empty
/// for other names.
std::string_view embedded_sim_file(std::string_view name) noexcept;

}  // namespace sandrunner
