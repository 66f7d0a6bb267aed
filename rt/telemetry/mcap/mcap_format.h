// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace sandrunner {

/// Largest message, schema or attachment that is written, bytes.
inline constexpr std::size_t kMcapMaxPayloadBytes = std::size_t{60} << 20;
/// Largest chunk that is read, uncompressed bytes.
inline constexpr std::size_t kMcapMaxChunkBytes = std::size_t{64} << 20;

using McapMap = std::map<std::string, std::string>;

/// Describes the messages of a channel.
struct McapSchema {
  std::uint16_t id = 0;  ///< never 0
  std::string name;      ///< "sensor_msgs/msg/JointState"
  std::string encoding;  ///< "ros2msg", "omgidl"
  std::string data;      ///< the definition itself

  bool operator==(const McapSchema&) const = default;
};

/// A stream of messages on a topic.
struct McapChannel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  ///< 0: no schema
  std::string topic;
  std::string message_encoding;  ///< "cdr"
  McapMap metadata;

  bool operator==(const McapChannel&) const = default;
};

/// One message. It does not own its data.
struct McapMessage {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;  ///< of the recorder
  std::uint64_t publish_time_ns = 0;
  std::span<const std::byte> data{};
};

/// A file inside the file.
struct McapAttachment {
  std::uint64_t log_time_ns = 0;
  std::uint64_t create_time_ns = 0;  ///< 0: unknown
  std::string name;
  std::string media_type;
  std::string data;  ///< any bytes
};

/// Keys and values under a name.
struct McapMetadata {
  std::string name;
  McapMap values;
};

// What reader and writer share: https://mcap.dev/spec

inline constexpr std::array<std::uint8_t, 8> kMcapMagic = {0x89, 'M',  'C',  'A',
                                                           'P',  0x30, '\r', '\n'};

enum McapOpcode : std::uint8_t {
  kMcapHeader = 0x01,
  kMcapFooter = 0x02,
  kMcapSchema = 0x03,
  kMcapChannel = 0x04,
  kMcapMessage = 0x05,
  kMcapChunk = 0x06,
  kMcapMessageIndex = 0x07,
  kMcapChunkIndex = 0x08,
  kMcapAttachment = 0x09,
  kMcapAttachmentIndex = 0x0A,
  kMcapStatistics = 0x0B,
  kMcapMetadata = 0x0C,
  kMcapMetadataIndex = 0x0D,
  kMcapSummaryOffset = 0x0E,
  kMcapDataEnd = 0x0F,
};

/// Type and length in front of every record, bytes.
inline constexpr std::size_t kMcapRecordHeadBytes = 9;

// Numbers are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little);

}  // namespace sandrunner
