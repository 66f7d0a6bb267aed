// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include "rt/base/errors.h"
#include "sim/ground/height_grid.h"

namespace sandrunner::sim {
namespace {

constexpr std::size_t kMostSamples = 1u << 24;

}  // namespace

HeightGrid read_height_grid(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: cannot be read, expected an ESRI ASCII grid", path));
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw InputError(fmt::format("{}: found {}, expected {}", path, found, expected));
  };
  double columns = 0.0, rows = 0.0, spacing_m = 0.0;
  double missing = std::numeric_limits<double>::quiet_NaN();
  std::string word;
  double value = 0.0;
  // Names and values, until a line begins with a number.
  while (file >> std::ws && std::isalpha(file.peek()) != 0) {
    file >> word >> value;
    if (!file) fail(fmt::format("no number after '{}'", word), "a name and a number");
    std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
    if (word == "ncols") columns = value;
    if (word == "nrows") rows = value;
    if (word == "cellsize") spacing_m = value;
    if (word == "nodata_value") missing = value;
  }
  const auto is_count = [](double n) { return n >= 2.0 && n <= 1e6 && n == std::floor(n); };
  if (!is_count(columns)) fail(fmt::format("ncols {}", columns), "a whole number from 2 on");
  if (!is_count(rows)) fail(fmt::format("nrows {}", rows), "a whole number from 2 on");
  if (columns * rows > double(kMostSamples)) {
    fail(fmt::format("{} x {} heights", columns, rows), fmt::format("at most {}", kMostSamples));
  }
  if (!(spacing_m >= 1e-3 && spacing_m <= 1e3)) {
    fail(fmt::format("cellsize {}", spacing_m), "a number from 0.001 to 1000 (m)");
  }
  const auto count = static_cast<std::size_t>(columns * rows);
  std::vector<double> heights_m;
  heights_m.reserve(count);
  while (file >> value) {
    if (value == missing) fail("a cell without a height", "one in every cell");
    if (!(std::abs(value) <= 1e4)) {
      fail(fmt::format("the height {}", value), "one from -10000 to 10000 (m)");
    }
    heights_m.push_back(value);
    if (heights_m.size() > count) break;
  }
  if (heights_m.size() != count || (!file.eof() && !(file >> std::ws).eof())) {
    fail(fmt::format("{} heights", heights_m.size()), fmt::format("{} x {}", columns, rows));
  }
  return {static_cast<std::size_t>(columns), static_cast<std::size_t>(rows), spacing_m,
          std::move(heights_m)};
}

}  // namespace sandrunner::sim
