// SPDX-License-Identifier: BSD-3-Clause
// The rows of rt/base/settings.h as the trainer reads them: every setting must be given.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/base/settings.h"

namespace sandrunner::train {

/// Throws InputError if `key` is not given.
inline void require_key(const ConfigTree& config, const std::string& key) {
  if (!config.has(key)) throw InputError(fmt::format("training config: '{}' is missing", key));
}

/// Reads all rows of `numbers` from the table `table`. Throws InputError for a number that is
/// missing or out of its range.
template <typename Settings, std::size_t kRows>
void read_numbers(ConfigTree& config, const std::string& table,
                  const Setting<Settings> (&numbers)[kRows], Settings& settings) {
  for (const Setting<Settings>& number : numbers) {
    const std::string key = table + "." + number.key;
    require_key(config, key);
    read_setting(config, key, number, settings);
  }
}

/// As read_numbers, for one integer.
inline int read_integer(ConfigTree& config, const std::string& key, int min, int max) {
  require_key(config, key);
  return static_cast<int>(config.integer(key, 0, min, max));
}

/// Throws InputError if the value of `low_key` is above that of `high_key`.
inline void require_order(const char* low_key, double low, const char* high_key, double high) {
  if (low > high) {
    throw InputError(
        fmt::format("training config: {} = {} above {} = {}", low_key, low, high_key, high));
  }
}

}  // namespace sandrunner::train
