// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace sandrunner {

/// Queue from one writing thread to one reading thread, for records and events. Both sides are
/// wait-free. When it is full the newest value is dropped and counted: the writer never waits.
///
/// Values are written and read in place. Exactly one thread may write and one may read.
template <typename T, std::size_t kCapacity>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(kCapacity > 0 && (kCapacity & (kCapacity - 1)) == 0, "a power of two");

 public:
  /// Writer: where the next value goes, or null if the ring is full, which counts as a drop.
  T* claim() noexcept {
    const std::uint64_t next = written_.value.load(std::memory_order_relaxed);
    if (next - writer_known_read_ == kCapacity) {
      writer_known_read_ = read_.value.load(std::memory_order_acquire);
      if (next - writer_known_read_ == kCapacity) {
        dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return nullptr;
      }
    }
    return &slots_[next % kCapacity];
  }
  /// Writer: hands over the value that was claimed.
  void publish() noexcept {
    written_.value.store(written_.value.load(std::memory_order_relaxed) + 1,
                         std::memory_order_release);
  }
  /// Writer: claim, copy, publish. False: dropped.
  bool push(const T& value) noexcept {
    T* slot = claim();
    if (!slot) return false;
    *slot = value;
    publish();
    return true;
  }

  /// Reader: the oldest value, or null if there is none. Valid until pop().
  const T* front() const noexcept {
    const std::uint64_t next = read_.value.load(std::memory_order_relaxed);
    if (written_.value.load(std::memory_order_acquire) == next) return nullptr;
    return &slots_[next % kCapacity];
  }
  /// Reader: gives the oldest value's place back.
  void pop() noexcept {
    read_.value.store(read_.value.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Values dropped so far. Any thread.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  struct alignas(64) Counter {
    std::atomic<std::uint64_t> value{0};
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  std::array<T, kCapacity> slots_{};
  Counter written_, read_;
  alignas(64) std::uint64_t writer_known_read_ = 0;  // spares the writer the reader's line
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace sandrunner
