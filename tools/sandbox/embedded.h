// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// The modules as built into the program: "relaxed.wasm.gz", "exact.wasm.gz"; empty for other
/// names.
std::string_view embedded_sandbox_file(std::string_view name) noexcept;

}  // namespace sandrunner
