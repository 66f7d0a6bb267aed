// SPDX-License-Identifier: BSD-3-Clause
// Settings as tables: a row says the key, the member and the range of a number.
#pragma once

namespace sandrunner {

/// A number of a configuration table: its key, where it goes, and its range, ends included.
template <typename Settings>
struct NumberSetting {
  const char* key;
  double Settings::*member;
  double min, max;
};

/// For numbers without an upper limit of their own.
inline constexpr double kNoLimit = 1e9;

}  // namespace sandrunner
