// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/data/ranks.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "rt/base/errors.h"

namespace sandrunner::learner {

Share Ranks::share_of(int rank, int count) const {
  const auto at = [&](std::int64_t r) { return static_cast<int>(r * count / size()); };
  return {at(rank), at(rank + 1)};
}

// Bytes of each rank's share.
std::vector<int> Ranks::parts_of(int count, std::size_t bytes_each) const {
  if (static_cast<std::size_t>(count) * bytes_each > std::numeric_limits<int>::max()) {
    throw InputError("run.envs: too many for several ranks, which would exchange 2 GiB at once");
  }
  std::vector<int> parts;
  for (int r = 0; r < size(); ++r) {
    parts.push_back(share_of(r, count).size() * static_cast<int>(bytes_each));
  }
  return parts;
}

void Ranks::gather_bytes(std::span<std::byte> data, int count) const {
  if (!exchange_ || count == 0) return;
  exchange_->gather(data, parts_of(count, data.size() / static_cast<std::size_t>(count)));
}

void Ranks::add_up(std::vector<std::vector<float>>& addends, int count, WorkerPool& pool) const {
  std::vector<float>& sum = addends.front();
  const auto whole = static_cast<int>(sum.size());
  const Share mine = share(whole);  // the elements that this rank adds up
  std::vector<float> got;           // of all addends
  if (exchange_) {
    const Share here = share(count);
    std::vector<float> given;
    for (int r = 0; r < size(); ++r) {
      const Share theirs = share_of(r, whole);
      for (int i = here.begin; i < here.end; ++i) {
        const auto addend = addends[static_cast<std::size_t>(i)].begin();
        given.insert(given.end(), addend + theirs.begin, addend + theirs.end);
      }
    }
    const std::size_t piece = sizeof(float) * static_cast<std::size_t>(mine.size());
    got.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(mine.size()));
    exchange_->trade(std::as_bytes(std::span(given)),
                     parts_of(whole, sizeof(float) * static_cast<std::size_t>(here.size())),
                     std::as_writable_bytes(std::span(got)), parts_of(count, piece));
    std::copy_n(got.begin(), mine.size(), sum.begin() + mine.begin);
  }
  constexpr int kRange = 16384;
  pool.run((mine.size() + kRange - 1) / kRange, [&](int range, int) {
    const int begin = mine.begin + range * kRange, end = std::min(begin + kRange, mine.end);
    for (int i = 1; i < count; ++i) {
      const float* addend = exchange_
                                ? got.data() + std::ptrdiff_t{i} * mine.size() + begin - mine.begin
                                : addends[static_cast<std::size_t>(i)].data() + begin;
      for (int k = begin; k < end; ++k) sum[static_cast<std::size_t>(k)] += *addend++;
    }
  });
  gather(std::span(sum), whole);
}

bool Ranks::agree(std::uint64_t here) const {
  std::vector<std::uint64_t> values(static_cast<std::size_t>(size()));
  values[static_cast<std::size_t>(rank())] = here;
  gather(std::span(values), size());
  return std::ranges::all_of(values, [&](std::uint64_t there) { return there == here; });
}

bool Ranks::any(bool here) const { return sum(here ? 1.0 : 0.0) > 0.0; }

double Ranks::sum(double here) const {
  std::vector<double> values(static_cast<std::size_t>(size()), 0.0);
  values[static_cast<std::size_t>(rank())] = here;
  gather(std::span(values), size());
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace sandrunner::learner
