// SPDX-License-Identifier: BSD-3-Clause
// Values as TOML has them. Only files that know toml++ include this.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sandrunner {

/// Letters, digits, _, - and the dot.
inline constexpr std::string_view kTomlPathCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";

std::string toml_text(const std::string& value);
/// Bytes that are not UTF-8 stay as they are, so that a reader refuses them.
std::string toml_quoted(const std::string& value);
/// The shortest digits that read back to the same bits.
std::string toml_text(double value);
/// An array; empty text if a number is not finite.
std::string toml_text(std::span<const double> values);

/// A key as it is written in a dotted path.
std::string key_text(std::string_view key);

/// What a message says of a value that was found.
std::string describe(const toml::node& node);

/// A number within the range, or nothing.
std::optional<double> number_in(const toml::node& node, double min, double max);

}  // namespace sandrunner
