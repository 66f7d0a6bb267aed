// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace sandrunner {

/// Counts of durations in nanoseconds, in buckets whose width is a 64th of their power of two:
/// quantiles are right to 1.6 %. Fixed in size, add() is real-time safe.
class LogHistogram {
 public:
  /// Negative durations count as 0.
  void add(std::int64_t duration_ns) noexcept {
    const auto v = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
    ++counts_[bucket_of(v)];
    ++count_;
    max_ns_ = std::max(max_ns_, v);
  }

  std::uint64_t count() const noexcept { return count_; }
  std::uint64_t max_ns() const noexcept { return max_ns_; }

  /// Smallest bucket's upper end below which at least `share` (0..1) of the durations lie, at most
  /// the maximum; 0 if empty.
  std::uint64_t quantile_ns(double share) const noexcept {
    if (count_ == 0) return 0;
    const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += counts_[i];
      if (seen >= std::max<std::uint64_t>(wanted, 1)) return std::min(upper_end(i), max_ns_);
    }
    return max_ns_;
  }

 private:
  static constexpr int kFineBits = 6;
  static constexpr std::uint64_t kFine = 1u << kFineBits;
  static constexpr std::size_t kBuckets = (64 - kFineBits + 1) * kFine;

  // Below 64 one bucket each; above, 64 to a power of two.
  static std::size_t bucket_of(std::uint64_t v) noexcept {
    if (v < kFine) return v;
    const int shift = 63 - std::countl_zero(v) - kFineBits;
    return (static_cast<std::size_t>(shift) + 1) * kFine + ((v >> shift) - kFine);
  }
  static std::uint64_t upper_end(std::size_t bucket) noexcept {
    if (bucket < kFine) return bucket;
    const auto shift = bucket / kFine - 1;
    return ((bucket % kFine + kFine + 1) << shift) - 1;
  }

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t count_ = 0, max_ns_ = 0;
};

}  // namespace sandrunner
