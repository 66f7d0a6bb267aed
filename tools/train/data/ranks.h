// SPDX-License-Identifier: BSD-3-Clause
// Several processes, ranks, that make one training. Each holds all of its state, works on its share
// of the blocks of environments and gets the rest from the others. What is added up is added in the
// order of the blocks, so weights do not depend on the number of ranks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "rt/base/worker_pool.h"

namespace sandrunner::learner {

/// How ranks give each other data. All of them call the same functions in the same order.
class Exchange {
 public:
  virtual ~Exchange() = default;
  virtual int rank() const = 0;  ///< 0 to size() - 1
  virtual int size() const = 0;
  /// `data`: bytes[r] of each rank r, in this order; a rank has its own and gets the others'.
  virtual void gather(std::span<std::byte> data, std::span<const int> bytes) = 0;
  /// Gives each rank r its part of `given`, given_bytes[r] in the order of the ranks, and gets
  /// got_bytes[r] of it.
  virtual void trade(std::span<const std::byte> given, std::span<const int> given_bytes,
                     std::span<std::byte> got, std::span<const int> got_bytes) = 0;

  struct Traffic {
    double got_bytes = 0.0;  ///< from other ranks
    double time_s = 0.0;     ///< in gather and trade, waiting for others included
  };
  /// So far, of this rank.
  virtual Traffic traffic() const = 0;
};

/// Numbers from `begin` to before `end`.
struct Share {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};

/// What the parts of a training do with the other ranks. A copy is for the same ranks. Throws
/// InputError if all ranks together would exchange 2 GiB at once, which MPI cannot.
class Ranks {
 public:
  Ranks() = default;  ///< one alone
  /// `exchange` must outlive all copies.
  explicit Ranks(Exchange& exchange) : exchange_(&exchange) {}

  int size() const { return exchange_ ? exchange_->size() : 1; }
  /// The one that writes files and lines.
  bool is_first() const { return rank() == 0; }
  /// This rank's share of `count` equal things.
  Share share(int count) const { return share_of(rank(), count); }

  /// Each rank has the values of its share of `count` equal things, and gets the others'.
  template <typename T>
  void gather(std::span<T> values, int count) const {
    static_assert(std::is_trivially_copyable_v<T>);
    gather_bytes(std::as_writable_bytes(values), count);
  }
  void gather_bytes(std::span<std::byte> data, int count) const;
  /// addends[0] becomes addends[0] + addends[1] + ... of the first `count`, added in this order.
  /// Each rank has those of its share; all have as many elements. Not from within a task of the
  /// pool.
  void add_up(std::vector<std::vector<float>>& addends, int count, WorkerPool& pool) const;
  /// Whether it holds for one of them.
  bool any(bool here) const;
  double sum(double here) const;
  /// Whether all have the same.
  bool agree(std::uint64_t here) const;

 private:
  int rank() const { return exchange_ ? exchange_->rank() : 0; }
  Share share_of(int rank, int count) const;
  std::vector<int> parts_of(int count, std::size_t bytes_each) const;

  Exchange* exchange_ = nullptr;
};

}  // namespace sandrunner::learner
