// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace sandrunner {

/// Files of the page as built into the program ("page.html", "page.css", "page.js.gz",
/// "unpack.js"); empty for other names.
std::string_view embedded_page_file(std::string_view name) noexcept;

}  // namespace sandrunner
