// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sandrunner {

/// Descriptions as built into the program ("himloco_go2.toml"); empty for other names.
std::string_view embedded_description(std::string_view name) noexcept;
std::vector<std::string> embedded_description_names();

}  // namespace sandrunner
