// SPDX-License-Identifier: BSD-3-Clause
// The rows of rt/base/settings.h as the trainer reads them: every setting must be given.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/base/settings.h"

namespace sandrunner::train {

/// Throws InputError if `key` is not given.
inline void require_key(const ConfigTree& config, const std::string& key) {
  if (!config.has(key)) throw InputError(fmt::format("training config: '{}' is missing", key));
}

/// Reads all rows of a table. Throws InputError for a setting that is missing or out of its range.
template <typename Settings>
void read_required(ConfigTree& config, const std::string& table, SettingRows<Settings> rows,
                   Settings& settings) {
  for (const Setting<Settings>& row : rows) require_key(config, setting_path(table, row.key));
  read_settings(config, table, rows, settings);
}

/// As read_required, for an array of numbers.
template <std::size_t kSize>
void read_array(ConfigTree& config, const std::string& key, double min, double max,
                std::array<double, kSize>& values) {
  require_key(config, key);
  std::ranges::copy(config.numbers(key, {}, kSize, min, max), values.begin());
}

/// Throws InputError if the number of `low_key` is above that of `high_key`. Both have been read.
inline void require_order(ConfigTree& config, const std::string& low_key,
                          const std::string& high_key) {
  constexpr double kAny = std::numeric_limits<double>::max();
  const double low = config.number(low_key, 0.0, -kAny, kAny);
  const double high = config.number(high_key, 0.0, -kAny, kAny);
  if (low > high) {
    throw InputError(
        fmt::format("training config: {} = {} above {} = {}", low_key, low, high_key, high));
  }
}

}  // namespace sandrunner::train
