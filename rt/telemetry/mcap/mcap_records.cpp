// SPDX-License-Identifier: BSD-3-Clause
// What each kind of record says.
#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "rt/telemetry/mcap/mcap_crc.h"
#include "rt/telemetry/mcap/mcap_fields.h"

namespace sandrunner {
namespace {

/// No zstd block holds more than 128 KiB in 4 bytes (format, section 3.1.1.2): with this limit, a
/// short chunk cannot ask for much memory.
constexpr std::uint64_t kMaxZstdRatio = (128U << 10) / 4U;

}  // namespace

bool McapReader::take_message(Fields fields) {
  message_.channel_id = fields.number<std::uint16_t>();
  message_.sequence = fields.number<std::uint32_t>();
  message_.log_time_ns = fields.number<std::uint64_t>();
  message_.publish_time_ns = fields.number<std::uint64_t>();
  message_.data = fields.rest();
  if (!channels_.contains(message_.channel_id)) {
    fail(fmt::format("found a message of channel {}, expected the channel before its messages",
                     message_.channel_id));
  }
  return true;
}

void McapReader::take_schema(Fields fields) {
  const std::size_t size = fields.left();
  McapSchema schema;
  schema.id = fields.number<std::uint16_t>();
  schema.name = fields.string();
  schema.encoding = fields.string();
  schema.data = fields.string();
  if (schema.id == 0) return;  // the specification says to ignore it
  const auto [known, is_new] = schemas_.try_emplace(schema.id, schema);
  if (is_new) return keep(size);
  if (known->second != schema) fail(fmt::format("found two schemas with the id {}", schema.id));
}

void McapReader::take_channel(Fields fields) {
  const std::size_t size = fields.left();
  const std::size_t kept_before = kept_bytes_;
  McapChannel channel;
  channel.id = fields.number<std::uint16_t>();
  channel.schema_id = fields.number<std::uint16_t>();
  channel.topic = fields.string();
  channel.message_encoding = fields.string();
  channel.metadata = fields.map();
  if (channel.schema_id != 0 && !schemas_.contains(channel.schema_id)) {
    fail(fmt::format("found a channel of schema {}, expected the schema before its channels",
                     channel.schema_id));
  }
  const auto [known, is_new] = channels_.try_emplace(channel.id, channel);
  if (is_new) return keep(size);
  kept_bytes_ = kept_before;
  if (known->second != channel) fail(fmt::format("found two channels with the id {}", channel.id));
}

void McapReader::take_chunk(Fields fields) {
  fields.bytes(16);  // its time span
  const auto size = fields.number<std::uint64_t>();
  const auto crc = fields.number<std::uint32_t>();
  const std::string compression = fields.string();
  const auto stored = fields.bytes(fields.number<std::uint64_t>());
  chunk_at_ = 0;
  chunk_.clear();
  if (size > kMcapMaxChunkBytes) {
    fail(fmt::format("found a chunk of {} bytes, expected at most {}", size, kMcapMaxChunkBytes));
  }
  if (compression.empty()) {
    if (size != stored.size()) {
      fail(fmt::format("found {} bytes in a chunk, expected {}", stored.size(), size));
    }
    chunk_.assign(stored.begin(), stored.end());
  } else if (compression == "zstd") {
    if (size / kMaxZstdRatio > stored.size()) {
      fail(fmt::format("found a chunk of {} bytes compressed to {}", size, stored.size()));
    }
    chunk_.resize(static_cast<std::size_t>(size));
    const std::size_t got =
        ZSTD_decompress(chunk_.data(), chunk_.size(), stored.data(), stored.size());
    if (got != chunk_.size()) {
      chunk_.clear();
      fail(ZSTD_isError(got)
               ? fmt::format("found a chunk that zstd refuses ({}), expected {} bytes",
                             ZSTD_getErrorName(got), size)
               : fmt::format("found {} bytes in a chunk, expected {}", got, size));
    }
  } else {
    fail(fmt::format("found a chunk compressed with '{}', expected zstd or none",
                     compression.substr(0, 16)));
  }
  check_crc("chunk", add_crc(0, chunk_), crc);
}

void McapReader::take_attachment(Fields fields) {
  const std::size_t size = fields.left();
  keep(size);
  McapAttachment attachment;
  attachment.log_time_ns = fields.number<std::uint64_t>();
  attachment.create_time_ns = fields.number<std::uint64_t>();
  attachment.name = fields.string();
  attachment.media_type = fields.string();
  attachment.data = fields.string(fields.number<std::uint64_t>());
  const std::size_t checked = size - fields.left();
  check_crc("attachment", add_crc(0, std::span(record_).first(checked)),
            fields.number<std::uint32_t>());
  attachments_.push_back(std::move(attachment));
}

void McapReader::take_metadata(Fields fields) {
  keep(fields.left());
  McapMetadata metadata;
  metadata.name = fields.string();
  metadata.values = fields.map();
  metadata_.push_back(std::move(metadata));
}

void McapReader::take_data_end(Fields fields, std::uint32_t data_crc) {
  // What was skipped is missing in it.
  check_crc("data section", data_crc, damaged_ ? 0 : fields.number<std::uint32_t>());
  summary_start_ = offset_;
  crc_ = 0;
}

void McapReader::take_footer(Fields fields, std::uint32_t crc) {
  ended_ = true;
  if (summary_start_ == 0) fail("found the footer, expected the end of the data before it");
  const auto summary_start = fields.number<std::uint64_t>();
  fields.bytes(8);  // where the summary's own index starts
  const auto stored_crc = fields.number<std::uint32_t>();
  if (fields.left() != 0) fail("found a long footer, expected 20 bytes");
  if (summary_start != 0) {
    if (summary_start != summary_start_) {
      fail(fmt::format("found the summary's place {}, expected {}", summary_start, summary_start_));
    }
    check_crc("summary", crc, stored_crc);
  }
  std::array<std::byte, kMcapMagic.size()> magic;
  const std::uint64_t before = offset_;
  const bool whole = read_bytes(magic);
  if (std::memcmp(magic.data(), kMcapMagic.data(), static_cast<std::size_t>(offset_ - before)) !=
      0) {
    fail("found other bytes after the footer, expected the end of an MCAP file");
  }
  if (whole && stream_.peek() != std::istream::traits_type::eof()) {
    fail("found more bytes after its end, expected none");
  }
  complete_ = whole;
}

}  // namespace sandrunner
