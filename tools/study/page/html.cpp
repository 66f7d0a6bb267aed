// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/page/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "rt/base/input_file.h"
#include "rt/telemetry/view/view_pack.h"

namespace sandrunner::study {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string from_markdown(std::string_view text) {
  std::string out;
  bool in_code = false;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('`', at), text.size());
    out += escaped(text.substr(at, end - at));
    if (end < text.size()) out += in_code ? "</code>" : "<code>";
    in_code = !in_code;
    at = end + 1;
  }
  return out;
}

std::string HtmlTable::html() const {
  std::string out = "<table><thead><tr>";
  for (const std::string& head : heads) out += fmt::format("<th>{}</th>", head);
  out += "</tr></thead><tbody>\n";
  for (const auto& row : rows) {
    out += "<tr>";
    for (const std::string& cell : row) out += fmt::format("<td>{}</td>", cell);
    out += "</tr>\n";
  }
  return out + "</tbody></table>\n";
}

std::string picture_html(const std::string& png_path, const std::string& alternative) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n", escaped(alternative),
                     base64(read_input_file(png_path, "a picture")));
}

}  // namespace sandrunner::study
