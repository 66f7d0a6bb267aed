// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace sandrunner {

/// CRC-32 of what `crc` is of (0: nothing), followed by `bytes`.
inline std::uint32_t add_crc(std::uint32_t crc, std::span<const std::byte> bytes) noexcept {
  if (bytes.empty()) return crc;  // a null pointer would make zlib start again
  return static_cast<std::uint32_t>(
      ::crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace sandrunner
