// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_pack.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <new>

namespace sandrunner {
namespace {

/// Appends bytes to a text, as gzip and base64, a piece at a time.
class PackedText {
 public:
  explicit PackedText(std::string& text) : text_(text) {
    constexpr int kLevel = 6, kGzip = 15 + 16, kMemory = 8;
    if (deflateInit2(&stream_, kLevel, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
    empty();
  }
  PackedText(const PackedText&) = delete;
  PackedText& operator=(const PackedText&) = delete;
  ~PackedText() { deflateEnd(&stream_); }

  void add(std::string_view bytes) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    while (stream_.avail_in > 0) {
      deflate(&stream_, Z_NO_FLUSH);
      if (stream_.avail_out == 0) append();
    }
  }

  void end() {
    while (deflate(&stream_, Z_FINISH) != Z_STREAM_END) append();
    append();
  }

 private:
  void append() {
    append_base64(text_, {packed_.data(), packed_.size() - stream_.avail_out});
    empty();
  }
  void empty() {
    stream_.next_out = reinterpret_cast<Bytef*>(packed_.data());
    stream_.avail_out = static_cast<uInt>(packed_.size());
  }

  z_stream stream_{};
  std::string& text_;
  std::array<char, 3 * 16384> packed_;  ///< full ones need no padding in base64
};

}  // namespace

void append_base64(std::string& text, std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
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
}

void append_gzip(std::string& text, std::string_view bytes) {
  PackedText packed(text);
  packed.add(bytes);
  packed.end();
}

void append_rows(std::string& text, std::span<const RowField> fields,
                 std::span<const std::byte* const> rows) {
  PackedText packed(text);
  std::string plane(rows.size(), '\0');
  for (const RowField& field : fields) {
    for (std::size_t k = 0; k < field.count; ++k) {
      for (std::size_t byte = 0; byte < field.width(); ++byte) {
        const std::size_t at = field.offset + field.width() * k + byte;
        std::ranges::transform(rows, plane.begin(),
                               [&](const std::byte* row) { return static_cast<char>(row[at]); });
        packed.add(plane);
      }
    }
  }
  packed.end();
}

}  // namespace sandrunner
