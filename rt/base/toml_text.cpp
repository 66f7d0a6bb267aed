// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/toml_text.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace sandrunner {

std::string toml_text(const std::string& value) {
  std::ostringstream out;
  out << toml::toml_formatter{toml::value<std::string>{value},
                              toml::format_flags::allow_unicode_strings};
  return out.str();
}

std::string toml_quoted(const std::string& value) {
  std::string quoted;
  for (const char c : value) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (code < 0x20 || code == 0x7f) {
      constexpr const char* kDigits = "0123456789abcdef";
      quoted += {'\\', 'u', '0', '0', kDigits[code >> 4], kDigits[code & 15]};
    } else {
      quoted += c;
    }
  }
  return '"' + quoted + '"';
}

std::string toml_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_text(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    if (!std::isfinite(value)) return {};
    text += (text.empty() ? "" : ", ") + toml_text(value);
  }
  return "[" + text + "]";
}

std::string describe(const toml::node& node) {
  constexpr std::size_t kLongest = 60;
  if (const auto* value = node.as_string()) {
    const std::string quoted = toml_text(value->get());
    return quoted.size() <= kLongest ? quoted : quoted.substr(0, kLongest) + "...";
  }
  if (const auto* value = node.as_floating_point()) return toml_text(value->get());
  if (const auto* value = node.as_integer()) return std::to_string(value->get());
  if (const auto* value = node.as_boolean()) return value->get() ? "true" : "false";
  if (const auto* value = node.as_array()) return fmt::format("an array of {}", value->size());
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::optional<double> number_in(const toml::node& node, double min, double max) {
  const std::optional<double> value = node.value<double>();
  if (!value || !(node.is_floating_point() || node.is_integer())) return std::nullopt;
  if (!std::isfinite(*value) || *value < min || *value > max) return std::nullopt;
  return value;
}

std::string key_text(std::string_view key) {
  const bool bare = key.find_first_not_of(kTomlPathCharacters) == std::string_view::npos &&
                    key.find('.') == std::string_view::npos && !key.empty();
  return bare ? std::string(key) : toml_text(std::string(key));
}

}  // namespace sandrunner
