// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/telemetry/mcap/mcap_format.h"

namespace sandrunner {

/// Writes an MCAP file with ROS 2's profile: messages in zstd chunks with CRC and index,
/// attachments, metadata, and at the end a summary to seek by. For one ordinary thread: it
/// allocates, compresses and writes.
///
/// Schemas and channels stand outside of the chunks, so that no damaged chunk takes them along.
///
/// What was handed over is in the file (in the hands of the kernel) after `flush()`, after about
/// 1 MiB of messages, and after each attachment and metadata record. If the process is killed after
/// that, it is not lost: such a truncated file is read up to its last whole chunk.
///
/// A write that fails (disk full) throws InputError once, one line with the path; the file is
/// truncated after the last whole record and stays readable. From then on, as after `close()`, all
/// calls do nothing.
class McapWriter {
 public:
  /// Creates or empties the file and writes its beginning. Throws InputError.
  explicit McapWriter(const std::string& path);
  /// Throws what the constructor would, and leaves a file at `path` as it is.
  static void try_path(const std::string& path);
  /// Without `close()` before: flushes and leaves a truncated file.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Returns the schema's id for `add_channel`, from 1. Throws InputError above
  /// kMcapMaxPayloadBytes or 65535 schemas.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);

  /// Returns the channel's id for messages, from 1; `schema_id` 0: no schema. The ROS 2 profile
  /// requires the key "offered_qos_profiles" in `metadata`. Throws InputError for an unknown
  /// schema.
  std::uint16_t add_channel(std::uint16_t schema_id, std::string_view topic,
                            std::string_view message_encoding, const McapMap& metadata);

  /// Appends a message to the open chunk. Throws InputError for an unknown channel and above
  /// kMcapMaxPayloadBytes; the message is then left out, and the file can be continued.
  void write_message(const McapMessage& message);

  /// Writes an attachment at once, before the messages of the open chunk. Throws InputError above
  /// kMcapMaxPayloadBytes.
  void write_attachment(const McapAttachment& attachment);

  /// Writes a metadata record at once, before the messages of the open chunk.
  void write_metadata(const McapMetadata& metadata);

  /// Ends the open chunk and hands it to the kernel. To be called once a second.
  void flush();

  /// Flushes and finishes the file with its summary.
  void close();

  /// Size of the file so far, without the open chunk.
  std::uint64_t bytes_written() const noexcept { return bytes_written_; }

 private:
  using Bytes = std::vector<std::byte>;

  /// Of one channel, whose id is its place, from 1.
  struct ChannelState {
    Bytes index;  ///< log time and place of each message in the open chunk
    std::uint64_t messages = 0;
  };
  struct TimeSpan {
    std::uint64_t messages = 0, first_ns = 0, last_ns = 0;
    void add(std::uint64_t time_ns) noexcept;
  };
  struct FreeCompressor {
    void operator()(void* context) const noexcept;
  };

  void write_declaration(const Bytes& record);
  void write_out(std::span<const std::byte> bytes);
  void give_up() noexcept;

  const std::string path_;
  int fd_ = -1;  ///< -1: closed or given up
  std::uint64_t bytes_written_ = 0;
  std::uint32_t data_crc_ = 0;

  std::unique_ptr<void, FreeCompressor> compressor_;
  Bytes chunk_;
  TimeSpan chunk_times_;
  std::vector<ChannelState> channels_;
  Bytes out_;

  // For the summary: records as they will be written.
  Bytes schema_records_, channel_records_;
  Bytes chunk_indexes_, attachment_indexes_, metadata_indexes_;
  TimeSpan times_;
  std::uint16_t schema_count_ = 0;
  std::uint32_t chunk_count_ = 0, attachment_count_ = 0, metadata_count_ = 0;
};

}  // namespace sandrunner
