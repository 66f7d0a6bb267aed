// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/urdf_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "rt/base/errors.h"

namespace sandrunner::sim {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// Where `tail` ends at or behind `begin`; the end of the text if it is not there.
std::size_t end_of(std::string_view text, std::string_view tail, std::size_t begin) {
  const std::size_t at = text.find(tail, begin);
  return at == std::string_view::npos ? text.size() : at + tail.size();
}

/// The end of the tag that begins at `begin`: behind the first > outside of quotes.
std::size_t end_of_tag(std::string_view text, std::size_t begin) {
  char quote = '\0';
  for (std::size_t at = begin; at < text.size(); ++at) {
    const char c = text[at];
    if (quote == '\0' && c == '>') return at + 1;
    if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = '\0';
    }
  }
  return text.size();
}

/// A tag without the blanks at both ends of its attributes' values. `name`: of the URDF.
std::string with_trimmed_values(std::string_view tag, const std::string& name) {
  std::string trimmed;
  std::size_t attributes = 0;
  for (std::size_t at = 0; at < tag.size();) {
    const std::size_t quote = std::min(tag.find_first_of("\"'", at), tag.size());
    const std::string_view names = tag.substr(at, quote - at);  // and values without quotes
    trimmed += names;
    attributes += static_cast<std::size_t>(std::ranges::count(names, '='));
    if (attributes > kMaxUrdfAttributes) {
      throw InputError(
          fmt::format("{}: an element has more than {} attributes", name, kMaxUrdfAttributes));
    }
    if (quote == tag.size()) break;
    const std::size_t end = std::min(tag.find(tag[quote], quote + 1), tag.size());
    std::string_view value = tag.substr(quote + 1, end - quote - 1);
    value.remove_prefix(std::min(value.find_first_not_of(kBlanks), value.size()));
    value = value.substr(0, value.find_last_not_of(kBlanks) + 1);
    trimmed += tag[quote];
    trimmed += value;
    if (end < tag.size()) trimmed += tag[end];
    at = std::min(end + 1, tag.size());
  }
  return trimmed;
}

}  // namespace

std::string tolerable_urdf(std::string_view text, const std::string& name) {
  if (text.size() > kMaxUrdfBytes) {
    throw InputError(fmt::format("{}: found {} bytes, expected at most {} of a URDF", name,
                                 text.size(), kMaxUrdfBytes));
  }
  std::string result;
  int depth = 0;
  std::size_t elements = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = std::min(text.find('<', at), text.size());
    result += text.substr(at, begin - at);
    const std::string_view rest = text.substr(begin);
    if (rest.starts_with("<!--")) {
      at = end_of(text, "-->", begin);
    } else if (rest.starts_with("<![CDATA[")) {
      at = end_of(text, "]]>", begin);
    } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
      at = end_of(text, ">", begin);
    } else {
      at = end_of_tag(text, begin);
      const std::string_view tag = text.substr(begin, at - begin);
      const bool closes = tag.starts_with("</");
      const bool empty = tag.ends_with("/>");
      if (closes) --depth;
      if (!closes && !tag.empty() && ++elements > kMaxUrdfElements) {
        throw InputError(fmt::format("{}: more than {} elements", name, kMaxUrdfElements));
      }
      if (!closes && !empty && ++depth > kMaxUrdfDepth) {
        throw InputError(fmt::format("{}: elements nested more than {} deep", name, kMaxUrdfDepth));
      }
      if (!(empty && tag.starts_with("<dynamics"))) result += with_trimmed_values(tag, name);
      continue;
    }
    result += text.substr(begin, at - begin);
  }
  return result;
}

}  // namespace sandrunner::sim
