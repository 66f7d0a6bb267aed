// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/likely_meant.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

namespace sandrunner {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, substituted}));
    }
  }
  return row.back();
}

std::string_view last_part(std::string_view path) {
  return path.substr(path.rfind('.') + 1);  // npos + 1 is 0
}

std::size_t distance(std::string_view unknown, std::string_view known) {
  if (last_part(known) == last_part(unknown)) return 1;
  // A key without its unit, an option cut short.
  const std::size_t edits = edit_distance(unknown, known);
  return known.starts_with(unknown) ? std::min<std::size_t>(edits, 2) : edits;
}

}  // namespace

std::string likely_meant(const std::string& unknown, const std::vector<std::string>& known) {
  constexpr std::size_t kLongest = 200;
  std::string best;
  if (unknown.empty() || unknown.size() > kLongest) return best;
  std::size_t best_distance = 3 + unknown.size() / 8;
  for (const std::string& candidate : known) {
    const std::size_t d = distance(unknown, candidate);
    // A change of more than half of a name says nothing: all short names are near each other.
    const std::size_t letters =
        candidate.size() - std::min(candidate.find_first_not_of('-'), candidate.size());
    const std::size_t most = std::min(letters, last_part(candidate).size()) / 2;
    if (d < best_distance && d <= most) {
      best = candidate;
      best_distance = d;
    }
  }
  return best;
}

std::string did_you_mean(const std::string& unknown, const std::vector<std::string>& known) {
  const std::string meant = likely_meant(unknown, known);
  return meant.empty() ? "" : ", did you mean '" + meant + "'?";
}

}  // namespace sandrunner
