// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/mcap/mcap_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/telemetry/mcap/mcap_crc.h"
#include "rt/telemetry/mcap/mcap_fields.h"

namespace sandrunner {
namespace {

/// Everything that the reader keeps: schemas, channels, attachments, metadata.
constexpr std::size_t kMaxKeptBytes = std::size_t{256} << 20;
/// Largest record that is read into memory: the largest chunk, uncompressed, with its fields.
constexpr std::uint64_t kMaxRecordBytes = kMcapMaxChunkBytes + (1U << 20);
/// Bodies are read in pieces of this size, so that a wrong length in a short file costs no memory.
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
/// Records that only seeking needs, and those of later versions.
bool is_skipped(std::uint8_t opcode) {
  return opcode == kMcapMessageIndex || opcode == kMcapChunkIndex ||
         opcode == kMcapAttachmentIndex || opcode == kMcapStatistics ||
         opcode == kMcapMetadataIndex || opcode == kMcapSummaryOffset || opcode > kMcapDataEnd;
}

/// A zstd chunk's record up to its compressed bytes: type, length, time span (16 bytes), size, CRC
/// (4), "zstd" and the length of what follows (8).
constexpr std::size_t kChunkHeadBytes = kMcapRecordHeadBytes + 16 + 8 + 4 + (4 + 4) + 8;

/// Whether these bytes can be such a head: its two lengths fit each other.
bool is_chunk_head(std::span<const std::byte> bytes) {
  constexpr std::array<std::byte, 8> kZstd = {std::byte{4},   std::byte{0},   std::byte{0},
                                              std::byte{0},   std::byte{'z'}, std::byte{'s'},
                                              std::byte{'t'}, std::byte{'d'}};
  if (static_cast<std::uint8_t>(bytes[0]) != kMcapChunk) return false;
  if (std::memcmp(&bytes[kMcapRecordHeadBytes + 28], kZstd.data(), kZstd.size()) != 0) return false;
  std::uint64_t length = 0, stored = 0;
  std::memcpy(&length, &bytes[1], sizeof length);
  std::memcpy(&stored, &bytes[kChunkHeadBytes - sizeof stored], sizeof stored);
  return length <= kMaxRecordBytes && length == kChunkHeadBytes - kMcapRecordHeadBytes + stored;
}

}  // namespace

McapReader::McapReader(const std::string& path) : stream_(file_), name_(path) {
  require_regular_file(path, "an MCAP file");
  errno = 0;
  file_.open(path, std::ios::binary);
  if (!file_) {
    throw InputError(one_line(
        fmt::format("{}: cannot be read ({}), expected an MCAP file", path, std::strerror(errno))));
  }
  read_header();
}

McapReader::McapReader(std::istream& stream, std::string name)
    : stream_(stream), name_(std::move(name)) {
  read_header();
}

void McapReader::read_header() {
  stream_.seekg(0, std::ios::end);
  size_ = static_cast<std::uint64_t>(stream_.tellg());
  stream_.seekg(0);
  std::array<std::byte, kMcapMagic.size()> magic;
  const bool whole = read_bytes(magic);
  const auto size = static_cast<std::size_t>(offset_);
  if (std::memcmp(magic.data(), kMcapMagic.data(), size) != 0) {
    fail("found other bytes, expected the beginning of an MCAP file");
  }
  ended_ = !whole;
  if (!ended_) take_from_file();
}

const McapMessage* McapReader::next() {
  while (!ended_) {
    if (chunk_at_ < chunk_.size() ? take_from_chunk() : take_from_file()) return &message_;
  }
  return nullptr;
}

bool McapReader::skip_damage() {
  if (summary_start_ != 0) return false;
  stream_.clear();
  // Pieces overlap by the head of a chunk less one byte, so that none is missed between two.
  constexpr std::size_t kOverlap = kChunkHeadBytes - 1;
  std::uint64_t begin = record_offset_ + 1;
  // The next chunk is often near.
  for (std::size_t size = 4096;; size = std::min(2 * size, kPieceBytes)) {
    Bytes piece(kOverlap + size);
    stream_.seekg(static_cast<std::streamoff>(begin));
    stream_.read(reinterpret_cast<char*>(piece.data()), static_cast<std::streamsize>(piece.size()));
    const auto got = static_cast<std::size_t>(stream_.gcount());
    stream_.clear();
    if (got < kChunkHeadBytes) return false;
    for (std::size_t at = 0; at + kChunkHeadBytes <= got; ++at) {
      if (!is_chunk_head(std::span(piece).subspan(at, kChunkHeadBytes))) continue;
      offset_ = begin + at;
      stream_.seekg(static_cast<std::streamoff>(offset_));
      ended_ = false;
      damaged_ = true;
      return true;
    }
    begin += got - kOverlap;
  }
}

/// Fills `to` from the file; false at its end.
bool McapReader::read_bytes(std::span<std::byte> to) {
  stream_.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size()));
  const auto got = static_cast<std::size_t>(stream_.gcount());
  offset_ += got;
  crc_ = add_crc(crc_, to.first(got));
  if (stream_.bad()) fail("found an error while reading, expected a readable file");
  return got == to.size();
}

/// Reads the body of a record into `record_`; false at the end of the file.
bool McapReader::read_body(std::uint64_t size) {
  if (size > kMaxRecordBytes) {
    fail(fmt::format("found a length of {} bytes, expected at most {}", size, kMaxRecordBytes));
  }
  if (offset_ > size_ || size > size_ - offset_)
    return false;  // nor is the rest read, for each such length
  record_.clear();
  while (record_.size() < size) {
    const std::size_t at = record_.size();
    record_.resize(at + std::min(kPieceBytes, static_cast<std::size_t>(size) - at));
    if (!read_bytes(std::span(record_).subspan(at))) return false;
  }
  return true;
}

bool McapReader::skip_body(std::uint64_t size) {
  record_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, kPieceBytes)));
  for (std::uint64_t left = size; left > 0;) {
    const std::size_t piece =
        static_cast<std::size_t>(std::min<std::uint64_t>(left, record_.size()));
    if (!read_bytes(std::span(record_).first(piece))) return false;
    left -= piece;
  }
  return true;
}

/// Takes the next record of the file; true when it is a message. Sets `ended_` at the end.
bool McapReader::take_from_file() {
  const bool first = offset_ == kMcapMagic.size();
  const std::uint32_t crc_before = crc_;
  record_offset_ = offset_;
  std::array<std::byte, kMcapRecordHeadBytes> head;
  ended_ = true;  // unless the whole record is there
  if (!read_bytes(head)) return false;
  const auto opcode = static_cast<std::uint8_t>(head[0]);
  std::uint64_t size = 0;
  std::memcpy(&size, &head[1], sizeof size);
  if (opcode == 0) fail("found type 0, expected the type of a record");
  if (first != (opcode == kMcapHeader)) {
    fail(fmt::format("found type 0x{:02x}, expected the header once, at the beginning", opcode));
  }
  // The summary repeats schemas and channels.
  const bool repeated = summary_start_ != 0 && (opcode == kMcapSchema || opcode == kMcapChannel);
  if (repeated || is_skipped(opcode)) {
    ended_ = !skip_body(size);
    return false;
  }
  if (summary_start_ != 0 && opcode != kMcapFooter) {
    fail(fmt::format("found type 0x{:02x} after the end of the data", opcode));
  }
  if (!read_body(size)) return false;
  ended_ = false;
  Fields fields(*this, record_);
  switch (opcode) {
    case kMcapHeader:
      profile_ = fields.string();
      library_ = fields.string();
      break;
    case kMcapFooter:
      take_footer(fields,
                  add_crc(add_crc(crc_before, head),
                          std::span(record_).first(std::min<std::size_t>(16, record_.size()))));
      break;
    case kMcapSchema:
      take_schema(fields);
      break;
    case kMcapChannel:
      take_channel(fields);
      break;
    case kMcapMessage:
      return take_message(fields);
    case kMcapChunk:
      take_chunk(fields);
      break;
    case kMcapAttachment:
      take_attachment(fields);
      break;
    case kMcapMetadata:
      take_metadata(fields);
      break;
    default:
      take_data_end(fields, crc_before);
  }
  return false;
}

/// Takes the next record of the chunk; true when it is a message.
bool McapReader::take_from_chunk() {
  Fields chunk(*this, std::span(chunk_).subspan(chunk_at_));
  const auto opcode = chunk.number<std::uint8_t>();
  const auto body = chunk.bytes(chunk.number<std::uint64_t>());
  chunk_at_ += kMcapRecordHeadBytes + body.size();
  const Fields fields(*this, body);
  if (opcode == kMcapMessage) return take_message(fields);
  if (opcode == kMcapSchema) {
    take_schema(fields);
  } else if (opcode == kMcapChannel) {
    take_channel(fields);
  } else if (opcode <= kMcapDataEnd) {
    fail(fmt::format("found type 0x{:02x} in a chunk, expected schemas, channels and messages",
                     opcode));
  }
  return false;
}

/// Counts what is kept in memory, with an allowance for its containers.
void McapReader::keep(std::size_t bytes) {
  kept_bytes_ += bytes + 256;
  if (kept_bytes_ > kMaxKeptBytes) {
    fail(fmt::format("found more than {} bytes of schemas, channels, attachments and metadata",
                     kMaxKeptBytes));
  }
}

/// 0 in the file means that no CRC was computed.
void McapReader::check_crc(std::string_view what, std::uint32_t computed, std::uint32_t stored) {
  if (stored == 0 || stored == computed) return;
  fail(fmt::format("found the CRC {:08x} of the {}, expected {:08x}", computed, what, stored));
}

void McapReader::fail(std::string_view found_and_expected) {
  ended_ = true;
  chunk_.clear();
  throw InputError(one_line(
      fmt::format("{}: record at byte {}: {}", name_, record_offset_, found_and_expected)));
}

}  // namespace sandrunner
