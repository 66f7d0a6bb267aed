// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <istream>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/telemetry/mcap/mcap_format.h"

namespace sandrunner {

/// Reads an MCAP file from beginning to end, in the order of the file and without its summary. So a
/// file truncated anywhere is read up to its last whole chunk.
///
///     McapReader reader("run.mcap");
///     while (const McapMessage* message = reader.next()) { ... }
///     if (!reader.complete()) { /* the recorder was killed, or the disk was full */ }
///
/// All CRCs are checked: that of a chunk before its first message is returned, that of an
/// attachment before it is stored, those of the data section and the summary at their end. Bytes
/// that are not an MCAP file throw InputError: one line with the path, the place, what was found
/// and what was expected; what was read before that stays valid. Memory is bounded whatever the
/// bytes are: for a chunk by kMcapMaxChunkBytes, for everything that is kept by 256 MiB. Chunks
/// are read as they are or compressed with zstd; others are refused.
class McapReader {
 public:
  /// Opens the file and reads its header. Throws InputError.
  explicit McapReader(const std::string& path);
  /// The same from any stream, which must outlive the reader; `name` appears in its errors.
  McapReader(std::istream& stream, std::string name);
  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  /// The next message, valid until the next call; nullptr at the end of the file, truncated or not.
  /// Throws InputError; calls after that return nullptr.
  const McapMessage* next();

  /// After an InputError of `next`, or at the end of a file that is not complete: goes on behind
  /// the damage, with the next chunk whose head is in order. False if there is none, or the damage
  /// is behind the data; then all stays as it is.
  bool skip_damage();

  /// After the end: whether the file is whole, not truncated.
  bool complete() const noexcept { return complete_; }

  const std::string& profile() const noexcept { return profile_; }
  const std::string& library() const noexcept { return library_; }

  // What was read so far. A channel and its schema are known before its first message.
  const std::map<std::uint16_t, McapSchema>& schemas() const noexcept { return schemas_; }
  const std::map<std::uint16_t, McapChannel>& channels() const noexcept { return channels_; }
  const std::vector<McapAttachment>& attachments() const noexcept { return attachments_; }
  const std::vector<McapMetadata>& metadata() const noexcept { return metadata_; }

 private:
  using Bytes = std::vector<std::byte>;
  class Fields;

  void read_header();
  bool read_bytes(std::span<std::byte> to);
  bool read_body(std::uint64_t size);
  bool skip_body(std::uint64_t size);
  bool take_from_file();
  bool take_from_chunk();
  bool take_message(Fields fields);
  void take_schema(Fields fields);
  void take_channel(Fields fields);
  void take_chunk(Fields fields);
  void take_attachment(Fields fields);
  void take_metadata(Fields fields);
  void take_data_end(Fields fields, std::uint32_t data_crc);
  void take_footer(Fields fields, std::uint32_t crc);
  void keep(std::size_t bytes);
  void check_crc(std::string_view what, std::uint32_t computed, std::uint32_t stored);
  [[noreturn]] void fail(std::string_view found_and_expected);

  std::ifstream file_;
  std::istream& stream_;
  std::string name_;
  std::uint64_t size_ = 0;           ///< of the file
  std::uint64_t offset_ = 0;         ///< bytes read from the file
  std::uint64_t record_offset_ = 0;  ///< where its current record starts
  std::uint32_t crc_ = 0;            ///< of the data section, then of the summary
  std::uint64_t summary_start_ = 0;  ///< 0: before it
  bool ended_ = false;
  bool complete_ = false;
  bool damaged_ = false;  ///< some was skipped

  Bytes record_;              ///< body of the current record
  Bytes chunk_;               ///< current chunk, uncompressed
  std::size_t chunk_at_ = 0;  ///< its next record
  std::size_t kept_bytes_ = 0;
  McapMessage message_;

  std::string profile_, library_;
  std::map<std::uint16_t, McapSchema> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
  std::vector<McapAttachment> attachments_;
  std::vector<McapMetadata> metadata_;
};

}  // namespace sandrunner
