// SPDX-License-Identifier: BSD-3-Clause
// Pieces of the page.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sandrunner::study {

/// The text as it stands in HTML.
std::string escaped(std::string_view text);

/// The same of a line of Markdown with `code` in it.
std::string from_markdown(std::string_view text);

/// A table; cells are HTML already.
struct HtmlTable {
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows;
  std::string html() const;
};

/// A PNG file of the folder as part of the page.
std::string picture_html(const std::string& png_path, const std::string& alternative);

}  // namespace sandrunner::study
