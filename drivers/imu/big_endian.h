// SPDX-License-Identifier: BSD-3-Clause
// Numbers as the sensors' protocols send them: most significant byte first.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sandrunner {

using Bytes = std::span<const std::uint8_t>;

/// The number at `offset`; the caller has checked that it is within the data.
template <typename Number>
Number read_big_endian(Bytes data, std::size_t offset) noexcept {
  Number value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    value = static_cast<Number>(value << 8 | data[offset + i]);
  }
  return value;
}
inline std::uint16_t read_u16(Bytes data, std::size_t offset) noexcept {
  return read_big_endian<std::uint16_t>(data, offset);
}
inline std::uint32_t read_u32(Bytes data, std::size_t offset) noexcept {
  return read_big_endian<std::uint32_t>(data, offset);
}
inline std::uint64_t read_u64(Bytes data, std::size_t offset) noexcept {
  return read_big_endian<std::uint64_t>(data, offset);
}

/// The first floats of the data, single precision; the caller has checked its length.
template <std::size_t kCount>
std::array<float, kCount> read_floats(Bytes data) noexcept {
  std::array<float, kCount> values;
  for (std::size_t i = 0; i < kCount; ++i) values[i] = std::bit_cast<float>(read_u32(data, 4 * i));
  return values;
}

/// Writes numbers one behind the other; the caller knows that `kCapacity` bytes suffice.
template <std::size_t kCapacity>
class BigEndianWriter {
 public:
  template <typename Number>
  BigEndianWriter& put(Number value) noexcept {
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      bytes_[size_++] = static_cast<std::uint8_t>(value >> (8 * i));
    }
    return *this;
  }
  template <std::size_t kCount>
  BigEndianWriter& put(const std::array<float, kCount>& values) noexcept {
    for (const float value : values) put(std::bit_cast<std::uint32_t>(value));
    return *this;
  }
  Bytes data() const noexcept { return {bytes_.data(), size_}; }

 private:
  std::array<std::uint8_t, kCapacity> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace sandrunner
