// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "drivers/imu/big_endian.h"

namespace sandrunner {

/// Finds a protocol's frames in a stream of bytes in which replies, data and garbage alternate as
/// they please. After a bad checksum the search goes on one byte behind the false beginning, so
/// that no frame inside a false one is lost. No heap.
///
/// What `Framing` tells of the protocol:
///   kFirstByte, kMaxSize   of every frame
///   size(begun)            how many bytes the frame takes that these begin, as far as they tell;
///                          no more than `begun` has only if complete; 0: no frame begins so
///   intact(frame)          whether its checksum is right
///   view(frame, time_ns)   what the parser hands on
template <typename Framing>
class FrameParser {
 public:
  /// Hands each frame that these bytes complete to `on_frame(view)`, which must not throw; the view
  /// is valid during that call. `time_ns`: when they were read; a frame has the time of its first
  /// byte.
  template <typename OnFrame>
  void feed(Bytes bytes, std::int64_t time_ns, OnFrame&& on_frame) noexcept {
    for (const std::uint8_t byte : bytes) {
      bytes_[size_] = byte;
      times_ns_[size_] = time_ns;
      ++size_;
      while (const std::size_t length = find()) {
        on_frame(Framing::view(Bytes(bytes_.data(), length), times_ns_[0]));
        drop(length);
      }
    }
  }

  /// Forgets a frame that has begun.
  void reset() noexcept { size_ = 0; }

  std::uint64_t skipped_bytes() const noexcept { return skipped_bytes_; }  ///< in no frame
  std::uint64_t bad_checksums() const noexcept { return bad_checksums_; }

 private:
  /// The size of the frame that the buffer begins with, 0 while there is none: what can't be the
  /// beginning of one has then been dropped.
  std::size_t find() noexcept {
    while (size_ > 0) {
      const Bytes begun(bytes_.data(), size_);
      if (const std::size_t length = Framing::size(begun)) {
        if (size_ < length) return 0;
        if (Framing::intact(begun.first(length))) return length;
        ++bad_checksums_;
      }
      const auto* const next =
          std::find(bytes_.data() + 1, bytes_.data() + size_, Framing::kFirstByte);
      const auto skipped = static_cast<std::size_t>(next - bytes_.data());
      skipped_bytes_ += skipped;
      drop(skipped);
    }
    return 0;
  }

  void drop(std::size_t count) noexcept {
    size_ -= count;
    std::memmove(bytes_.data(), bytes_.data() + count, size_);
    std::memmove(times_ns_.data(), times_ns_.data() + count, size_ * sizeof(times_ns_[0]));
  }

  std::array<std::uint8_t, Framing::kMaxSize> bytes_{};
  std::array<std::int64_t, Framing::kMaxSize> times_ns_{};
  std::size_t size_ = 0;
  std::uint64_t skipped_bytes_ = 0;
  std::uint64_t bad_checksums_ = 0;
};

}  // namespace sandrunner
