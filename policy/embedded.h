// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// The policies that ship, as built into the program; empty for other names.
std::string_view embedded_policy_file(std::string_view name) noexcept;

}  // namespace sandrunner
