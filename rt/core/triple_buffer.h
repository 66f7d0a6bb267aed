// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace sandrunner {

/// Hands the latest value of one writing thread to one reading thread. Both sides are wait-free: a
/// write and a read are one exchange each, whatever the other side does and whichever side preempts
/// the other. A value that is not read before the next write is gone; the sequence numbers show it.
///
/// Three slots: the writer owns one, the reader owns one, the third changes hands. Exactly one
/// thread may write and one may read.
template <typename T>
class TripleBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Publishes `value`; its sequence number is one above the last one's, the first one's is 1.
  void write(const T& value) noexcept {
    Slot& slot = slots_[writer_.index];
    slot.value = value;
    slot.sequence = ++writer_.sequence;
    const std::uint8_t old = middle_.exchange(static_cast<std::uint8_t>(writer_.index | kFresh),
                                              std::memory_order_acq_rel);
    writer_.index = old & kIndex;
  }

  /// The newest value; a value-initialised one before the first write. Stays as it is until the
  /// next read.
  const T& read() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      reader_.index =
          middle_.exchange(static_cast<std::uint8_t>(reader_.index), std::memory_order_acq_rel) &
          kIndex;
    }
    return slots_[reader_.index].value;
  }

  /// Reader's side: sequence number of what read() returned last; 0 before the first write.
  std::uint64_t sequence() const noexcept { return slots_[reader_.index].sequence; }

 private:
  static constexpr std::uint8_t kIndex = 3, kFresh = 4;
  // On cache lines of their own: neither side waits for the other's line.
  struct alignas(64) Slot {
    T value{};
    std::uint64_t sequence = 0;
  };
  struct alignas(64) Writer {
    unsigned index = 0;
    std::uint64_t sequence = 0;
  };
  struct alignas(64) Reader {
    unsigned index = 1;
  };
  std::array<Slot, 3> slots_{};
  Writer writer_;
  Reader reader_;
  alignas(64) std::atomic<std::uint8_t> middle_{2};
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);
};

}  // namespace sandrunner
