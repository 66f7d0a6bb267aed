// SPDX-License-Identifier: BSD-3-Clause
// Values that have a name in files: one table of rows {value, name} for both ways.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "policy/text.h"

namespace sandrunner {

template <typename Value>
struct Named {
  Value value;
  const char* name;
};

/// The names of a table, for people.
template <typename Rows>
std::string names_of(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return joined(names, ", ");
}

/// The value of this name. Throws InputError, which begins with `where`.
template <typename Value, std::size_t kCount>
Value value_named(const Named<Value> (&rows)[kCount], const std::string& where,
                  const std::string& name) {
  for (const Named<Value>& row : rows) {
    if (name == row.name) return row.value;
  }
  throw InputError(
      fmt::format("{}: found '{}', expected one of {}", where, printable(name), names_of(rows)));
}

/// The way back.
template <typename Value, std::size_t kCount>
const char* name_of(const Named<Value> (&rows)[kCount], Value value) {
  return std::ranges::find_if(rows, [&](const Named<Value>& row) { return row.value == value; })
      ->name;
}

}  // namespace sandrunner
