// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/html.h"

#include <fmt/format.h>

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
