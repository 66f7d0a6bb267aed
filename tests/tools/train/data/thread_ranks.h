// SPDX-License-Identifier: BSD-3-Clause
// Ranks that are threads of the test.
#pragma once

#include <algorithm>
#include <barrier>
#include <functional>
#include <thread>
#include <vector>

#include "tools/train/data/ranks.h"

namespace sandrunner::learner {

/// Calls `run` with each of `size` ranks, in a thread of its own, and waits for all.
inline void run_ranks(int size, const std::function<void(const Ranks&, int rank)>& run) {
  // What a rank shows the others between two meetings.
  struct Shown {
    const std::byte* data = nullptr;
    std::vector<int> bytes;
  };
  struct Meeting {
    std::vector<Shown> shown;
    std::barrier<> barrier;
  };
  class ThreadExchange final : public Exchange {
   public:
    ThreadExchange(Meeting& meeting, int rank) : meeting_(meeting), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return static_cast<int>(meeting_.shown.size()); }
    void gather(std::span<std::byte> data, std::span<const int> bytes) override {
      show(data.data(), bytes);
      std::byte* to = data.data();
      for (int r = 0; r < size(); to += bytes[r++]) {
        if (r != rank_) std::copy_n(from(r, r), bytes[r], to);
      }
      meeting_.barrier.arrive_and_wait();
    }
    void trade(std::span<const std::byte> given, std::span<const int> given_bytes,
               std::span<std::byte> got, std::span<const int> got_bytes) override {
      show(given.data(), given_bytes);
      std::byte* to = got.data();
      for (int r = 0; r < size(); to += got_bytes[r++])
        std::copy_n(from(r, rank_), got_bytes[r], to);
      meeting_.barrier.arrive_and_wait();
    }

    Traffic traffic() const override { return {}; }

   private:
    void show(const std::byte* data, std::span<const int> bytes) {
      meeting_.shown[static_cast<std::size_t>(rank_)] = {data, {bytes.begin(), bytes.end()}};
      meeting_.barrier.arrive_and_wait();
    }
    // Part number `part` of what a rank shows.
    const std::byte* from(int rank, int part) const {
      const Shown& shown = meeting_.shown[static_cast<std::size_t>(rank)];
      const std::byte* at = shown.data;
      for (int r = 0; r < part; ++r) at += shown.bytes[static_cast<std::size_t>(r)];
      return at;
    }
    Meeting& meeting_;
    const int rank_;
  };
  Meeting meeting{std::vector<Shown>(static_cast<std::size_t>(size)), std::barrier<>(size)};
  std::vector<std::thread> threads;
  for (int rank = 0; rank < size; ++rank) {
    threads.emplace_back([&, rank] {
      ThreadExchange exchange(meeting, rank);
      run(Ranks(exchange), rank);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace sandrunner::learner
