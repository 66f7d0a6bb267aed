// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sandrunner {

/// Writes classic CDR, little-endian, with its 4-byte encapsulation header: what ROS 2 puts on the
/// wire and into files. Numbers are aligned to their own size, counted from the end of the header.
class CdrWriter {
 public:
  CdrWriter() : bytes_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}} {}

  template <typename T>
  CdrWriter& number(T value) {
    static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
    align(sizeof value);
    raw(std::as_bytes(std::span(&value, 1)));
    return *this;
  }
  template <typename Range>
  CdrWriter& numbers(const Range& values) {
    for (const auto value : values) number(value);
    return *this;
  }
  /// The length, then the elements.
  template <typename Range>
  CdrWriter& sequence(const Range& values) {
    number(static_cast<std::uint32_t>(std::size(values)));
    return numbers(values);
  }
  CdrWriter& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    raw(std::as_bytes(std::span(value)));
    bytes_.push_back(std::byte{0});
    return *this;
  }
  /// Bytes as they are, beginning at a multiple of `alignment`.
  CdrWriter& block(std::span<const std::byte> bytes, std::size_t alignment) {
    align(alignment);
    raw(bytes);
    return *this;
  }

  std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  static constexpr std::size_t kHeader = 4;
  void align(std::size_t size) {
    while ((bytes_.size() - kHeader) % size != 0) bytes_.push_back(std::byte{0});
  }
  void raw(std::span<const std::byte> bytes) {
    // Not insert(): g++ 12 at -O3 warns of an overflow in it that cannot happen.
    const std::size_t at = bytes_.size();
    bytes_.resize(at + bytes.size());
    if (!bytes.empty()) std::memcpy(bytes_.data() + at, bytes.data(), bytes.size());
  }
  std::vector<std::byte> bytes_;
};

/// Reads what CdrWriter writes. Reading past the end sets failed() and returns zeros.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    failed_ = bytes.size() < kHeader || bytes[0] != std::byte{0} || bytes[1] != std::byte{1};
  }
  template <typename T>
  T number() {
    T value{};
    const std::span<const std::byte> from = block(sizeof value, sizeof value);
    if (!failed_) std::memcpy(&value, from.data(), sizeof value);
    return value;
  }
  std::string text() {
    const auto size = number<std::uint32_t>();
    const std::span<const std::byte> bytes = block(size, 1);
    if (bytes.empty()) failed_ = true;  // not even the zero behind it
    return failed_ ? std::string()
                   : std::string(reinterpret_cast<const char*>(bytes.data()), size - 1);
  }
  std::span<const std::byte> block(std::size_t size, std::size_t alignment) {
    while ((at_ - kHeader) % alignment != 0) ++at_;
    if (failed_ || at_ > bytes_.size() || bytes_.size() - at_ < size) {
      failed_ = true;
      return {};
    }
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }
  bool failed() const noexcept { return failed_; }
  std::size_t left() const noexcept { return failed_ ? 0 : bytes_.size() - at_; }

 private:
  static constexpr std::size_t kHeader = 4;
  std::span<const std::byte> bytes_;
  std::size_t at_ = kHeader;
  bool failed_;
};

}  // namespace sandrunner
