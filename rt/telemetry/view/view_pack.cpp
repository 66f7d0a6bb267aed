// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_pack.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>

namespace sandrunner {

std::string gzip(std::string_view bytes) {
  constexpr int kLevel = 6, kGzip = 15 + 16, kMemory = 8;
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);  // into the bound: all of it
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < here ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= here ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

std::string pack_rows(std::span<const RowField> fields, std::span<const std::byte> rows,
                      std::size_t row_bytes) {
  std::string planes;
  planes.reserve(rows.size());
  for (const RowField& field : fields) {
    for (std::size_t k = 0; k < field.count; ++k) {
      for (std::size_t byte = 0; byte < field.width(); ++byte) {
        const std::size_t at = field.offset + field.width() * k + byte;
        for (std::size_t row = 0; row < rows.size(); row += row_bytes) {
          planes += static_cast<char>(rows[row + at]);
        }
      }
    }
  }
  return base64(gzip(planes));
}

}  // namespace sandrunner
