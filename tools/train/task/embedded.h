// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// The training's settings as built into the program ("training.toml"); empty for other names.
std::string_view embedded_train_file(std::string_view name) noexcept;

}  // namespace sandrunner
