// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// Robot files as built into the program ("raibo.urdf", "raibo.toml"); empty for other names.
std::string_view embedded_robot_file(std::string_view name) noexcept;

}  // namespace sandrunner
