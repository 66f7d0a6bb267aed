// SPDX-License-Identifier: BSD-3-Clause
// A recording whose every byte follows from the number of its messages; npm/check_mcap.mjs knows
// the same rules.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "rt/telemetry/mcap/mcap_writer.h"

namespace sandrunner {

inline constexpr std::uint64_t kSampleStartNs = 1'700'000'000'000'000'000;

inline std::uint16_t sample_channel_id(int i) { return static_cast<std::uint16_t>(1 + i % 3); }

/// Data of message `i`: 40 to 339 bytes.
inline std::string sample_data(int i) {
  std::string data(40U + static_cast<unsigned>(i * 7 % 300), '\0');
  for (std::size_t j = 0; j < data.size(); ++j) {
    data[j] = static_cast<char>(static_cast<std::size_t>(i) * 31 + j * j / 5);
  }
  return data;
}

inline void write_sample_message(McapWriter& writer, int i) {
  const std::string data = sample_data(i);
  const std::uint64_t time_ns = kSampleStartNs + static_cast<std::uint64_t>(i) * 250'000;
  writer.write_message({.channel_id = sample_channel_id(i),
                        .sequence = static_cast<std::uint32_t>(i / 3),
                        .log_time_ns = time_ns,
                        .publish_time_ns = time_ns - 1000,
                        .data = std::as_bytes(std::span(data))});
}

inline void write_sample_start(McapWriter& writer) {
  const std::uint16_t number = writer.add_schema("std_msgs/msg/Int32", "ros2msg", "int32 data\n");
  const std::uint16_t own =
      writer.add_schema("sandrunner::Tick", "omgidl", "struct Tick { long long tick; };\n");
  writer.add_channel(number, "/number", "cdr", {{"offered_qos_profiles", ""}});
  writer.add_channel(own, "/tick", "cdr", {{"offered_qos_profiles", ""}, {"rate_hz", "4000"}});
  writer.add_channel(own, "/policy_tick", "cdr", {});
  writer.write_attachment({.log_time_ns = kSampleStartNs,
                           .create_time_ns = 5,
                           .name = "config.toml",
                           .media_type = "application/toml",
                           .data = "gain = 1.0\n"});
  writer.write_metadata({.name = "build", .values = {{"compiler", "g++"}, {"version", "1"}}});
}

/// `flush_every`: messages per chunk; 0: as the writer decides.
inline void write_sample(McapWriter& writer, int messages, int flush_every) {
  write_sample_start(writer);
  for (int i = 0; i < messages; ++i) {
    write_sample_message(writer, i);
    if (flush_every != 0 && (i + 1) % flush_every == 0) writer.flush();
  }
  writer.write_attachment({.name = "empty", .media_type = "application/octet-stream", .data = {}});
}

}  // namespace sandrunner
