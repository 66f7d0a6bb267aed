// SPDX-License-Identifier: BSD-3-Clause
// The way back from pack_rows, for tests.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/report/run_row.h"

namespace sandrunner {

inline std::string from_base64(std::string_view text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<unsigned>(kDigits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

inline std::string gunzip(const std::string& packed) {
  std::string bytes(64 << 20, '\0');
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  inflateEnd(&stream);
  return bytes;
}

/// The rows that pack_rows packed; bytes that are in no field are zero.
template <typename Row>
std::vector<Row> unpacked(std::span<const RowField> fields, std::string_view packed) {
  const std::string planes = gunzip(from_base64(packed));
  std::size_t per_row = 0;
  for (const RowField& f : fields) per_row += f.count * f.width();
  std::vector<Row> rows(planes.size() / per_row);
  std::size_t from = 0;
  for (const RowField& f : fields) {
    for (std::size_t at = f.offset; at < f.offset + f.count * f.width(); ++at) {
      for (Row& row : rows) std::memcpy(reinterpret_cast<char*>(&row) + at, &planes[from++], 1);
    }
  }
  return rows;
}

/// What stands between the tags of the page's element `id`.
inline std::string element(const std::string& page, const std::string& id) {
  const std::size_t begin = page.find('>', page.find("id=\"" + id + "\"")) + 1;
  return page.substr(begin, page.find("</script>", begin) - begin);
}

}  // namespace sandrunner
