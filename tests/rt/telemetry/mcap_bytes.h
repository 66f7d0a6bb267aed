// SPDX-License-Identifier: BSD-3-Clause
// MCAP files byte by byte, from the specification and without the writer: https://mcap.dev/spec
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sandrunner {

inline const std::string kMagic = "\x89MCAP0\r\n";

/// Little endian.
inline std::string number(std::uint64_t value, std::size_t bytes) {
  std::string result;
  for (; result.size() < bytes; value >>= 8) result += static_cast<char>(value);
  return result;
}

inline std::string text(std::string_view value) { return number(value.size(), 4).append(value); }

inline std::string record(int opcode, std::string_view body) {
  return number(static_cast<std::uint64_t>(opcode), 1) + number(body.size(), 8).append(body);
}

inline std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()),
                                            static_cast<unsigned>(bytes.size())));
}

inline std::string header(std::string_view library) {
  return record(0x01, text("ros2") + text(library));
}

inline std::string schema(int id, std::string_view name) {
  return record(0x03, number(static_cast<std::uint64_t>(id), 2) + text(name) + text("ros2msg") +
                          text("int32 x\n"));
}

inline std::string channel(int id, int schema_id, std::string_view topic) {
  return record(0x04, number(static_cast<std::uint64_t>(id), 2) +
                          number(static_cast<std::uint64_t>(schema_id), 2) + text(topic) +
                          text("cdr") + text(text("k") + text("v")));
}

inline std::string message(int channel_id, std::uint64_t time_ns, std::string_view data) {
  return record(0x05, (number(static_cast<std::uint64_t>(channel_id), 2) + number(7, 4) +
                       number(time_ns, 8) + number(time_ns - 1, 8))
                          .append(data));
}

/// `stored`: the records as they are in the file. CRC 0: not to be checked.
inline std::string chunk(std::uint64_t uncompressed_size, std::uint32_t uncompressed_crc,
                         std::string_view compression, std::string_view stored) {
  return record(0x06, (number(0, 16) + number(uncompressed_size, 8) + number(uncompressed_crc, 4) +
                       text(compression) + number(stored.size(), 8))
                          .append(stored));
}

/// What comes after the data section when there is no summary.
inline std::string ending(std::string_view data_section) {
  return record(0x0F, number(crc(data_section), 4)) + record(0x02, number(0, 20)) + kMagic;
}

/// A whole file around one chunk that is not compressed and has no CRC.
inline std::string file_with_chunk(std::string_view records) {
  const std::string data = kMagic + header("by hand") + chunk(records.size(), 0, "", records);
  return data + ending(data);
}

}  // namespace sandrunner
