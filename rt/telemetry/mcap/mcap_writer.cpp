// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/mcap/mcap_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include "rt/base/errors.h"
#include "rt/telemetry/mcap/mcap_crc.h"

namespace sandrunner {
namespace {

using Bytes = std::vector<std::byte>;

/// A chunk ends when it holds this much, uncompressed.
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
/// Fast, because the recorder shares the computer with the robot's other work: see README.md.
constexpr int kCompressionLevel = 1;

void put_bytes(Bytes& to, const void* bytes, std::size_t size) {
  // Not insert(): g++ 12 at -O3 warns of an overflow in it that cannot happen.
  const std::size_t at = to.size();
  to.resize(at + size);
  if (size > 0) std::memcpy(to.data() + at, bytes, size);
}

template <typename Number>
void put(Bytes& to, Number value) {
  put_bytes(to, &value, sizeof value);
}

void put(Bytes& to, std::string_view text) {
  put(to, static_cast<std::uint32_t>(text.size()));
  put_bytes(to, text.data(), text.size());
}

/// Opens `path` for writing and creates it if necessary; does not follow a symbolic link. Throws
/// InputError.
int open_file(const std::string& path, int flags) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | flags, 0644);
  if (fd < 0) {
    throw InputError(
        one_line(fmt::format("{}: cannot be written ({}), expected a path for an MCAP", path,
                             errno == ELOOP ? "it is a symbolic link" : std::strerror(errno))));
  }
  return fd;
}

/// Appends what `body` appends, preceded by its length, a `Length`.
template <typename Length, typename Body>
void put_with_length(Bytes& to, const Body& body) {
  const std::size_t at = to.size();
  put(to, Length{0});
  body();
  const Length length = static_cast<Length>(to.size() - at - sizeof(Length));
  std::memcpy(&to[at], &length, sizeof length);
}

template <typename Body>
void put_record(Bytes& to, McapOpcode opcode, const Body& body) {
  put(to, opcode);
  put_with_length<std::uint64_t>(to, body);
}

void put(Bytes& to, const McapMap& map) {
  put_with_length<std::uint32_t>(to, [&] {
    for (const auto& [key, value] : map) {
      put(to, std::string_view(key));
      put(to, std::string_view(value));
    }
  });
}

void check_size(const std::string& path, std::string_view what, std::size_t size) {
  if (size <= kMcapMaxPayloadBytes) return;
  throw InputError(one_line(fmt::format("{}: found a {} of {} bytes, expected at most {}", path,
                                        what, size, kMcapMaxPayloadBytes)));
}

std::size_t size_of(const McapMap& map) {
  std::size_t size = 0;
  for (const auto& [key, value] : map) size += key.size() + value.size() + 8;
  return size;
}

InputError write_error(const std::string& path, int error, std::uint64_t bytes_written) {
  return InputError(one_line(fmt::format("{}: cannot be written ({}), its first {} bytes are kept",
                                         path, std::strerror(error), bytes_written)));
}

}  // namespace

void McapWriter::TimeSpan::add(std::uint64_t time_ns) noexcept {
  first_ns = messages == 0 ? time_ns : std::min(first_ns, time_ns);
  last_ns = std::max(last_ns, time_ns);
  ++messages;
}

void McapWriter::FreeCompressor::operator()(void* context) const noexcept {
  ZSTD_freeCCtx(static_cast<ZSTD_CCtx*>(context));
}

void McapWriter::try_path(const std::string& path) {
  struct stat before{};
  const bool there = ::stat(path.c_str(), &before) == 0;
  ::close(open_file(path, 0));
  if (!there) ::unlink(path.c_str());
}

McapWriter::McapWriter(const std::string& path) : path_(path), compressor_(ZSTD_createCCtx()) {
  if (!compressor_) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(static_cast<ZSTD_CCtx*>(compressor_.get()), ZSTD_c_compressionLevel,
                         kCompressionLevel);
  fd_ = open_file(path, O_TRUNC);
  put_bytes(out_, kMcapMagic.data(), kMcapMagic.size());
  put_record(out_, kMcapHeader, [&] {
    put(out_, std::string_view("ros2"));
    put(out_, std::string_view("sandrunner " SANDRUNNER_VERSION));
  });
  write_out(out_);
}

McapWriter::~McapWriter() {
  try {
    flush();
  } catch (const std::exception&) {  // there is nobody left to tell
  }
  give_up();
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                     std::string_view data) {
  check_size(path_, "schema", name.size() + encoding.size() + data.size());
  if (schema_count_ == std::numeric_limits<std::uint16_t>::max()) {
    throw InputError(one_line(
        fmt::format("{}: found one more schema, expected at most {}", path_, schema_count_)));
  }
  const std::uint16_t id = ++schema_count_;
  Bytes record;
  put_record(record, kMcapSchema, [&] {
    put(record, id);
    put(record, name);
    put(record, encoding);
    put(record, data);
  });
  put_bytes(schema_records_, record.data(), record.size());
  write_declaration(record);
  return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema_id, std::string_view topic,
                                      std::string_view message_encoding, const McapMap& metadata) {
  check_size(path_, "channel", topic.size() + message_encoding.size() + size_of(metadata));
  if (schema_id > schema_count_) {
    throw InputError(one_line(fmt::format("{}: found schema {} for topic {}, expected at most {}",
                                          path_, schema_id, topic, schema_count_)));
  }
  if (channels_.size() == std::numeric_limits<std::uint16_t>::max()) {
    throw InputError(one_line(
        fmt::format("{}: found one more channel, expected at most {}", path_, channels_.size())));
  }
  channels_.emplace_back();
  const auto id = static_cast<std::uint16_t>(channels_.size());
  Bytes record;
  put_record(record, kMcapChannel, [&] {
    put(record, id);
    put(record, schema_id);
    put(record, topic);
    put(record, message_encoding);
    put(record, metadata);
  });
  put_bytes(channel_records_, record.data(), record.size());
  write_declaration(record);
  return id;
}

void McapWriter::write_declaration(const Bytes& record) {
  if (fd_ >= 0) write_out(record);
}

void McapWriter::write_message(const McapMessage& message) {
  if (fd_ < 0) return;
  if (message.channel_id == 0 || message.channel_id > channels_.size()) {
    throw InputError(one_line(fmt::format("{}: found a message of channel {}, expected 1 to {}",
                                          path_, message.channel_id, channels_.size())));
  }
  check_size(path_, "message", message.data.size());
  ChannelState& channel = channels_[message.channel_id - 1U];
  put(channel.index, message.log_time_ns);
  put(channel.index, static_cast<std::uint64_t>(chunk_.size()));
  ++channel.messages;
  chunk_times_.add(message.log_time_ns);
  times_.add(message.log_time_ns);
  put_record(chunk_, kMcapMessage, [&] {
    put(chunk_, message.channel_id);
    put(chunk_, message.sequence);
    put(chunk_, message.log_time_ns);
    put(chunk_, message.publish_time_ns);
    put_bytes(chunk_, message.data.data(), message.data.size());
  });
  if (chunk_.size() >= kChunkBytes) flush();
}

void McapWriter::write_attachment(const McapAttachment& attachment) {
  if (fd_ < 0) return;
  check_size(path_, "attachment",
             attachment.name.size() + attachment.media_type.size() + attachment.data.size());
  const std::uint64_t start = bytes_written_;
  out_.clear();
  put_record(out_, kMcapAttachment, [&] {
    put(out_, attachment.log_time_ns);
    put(out_, attachment.create_time_ns);
    put(out_, std::string_view(attachment.name));
    put(out_, std::string_view(attachment.media_type));
    put(out_, static_cast<std::uint64_t>(attachment.data.size()));
    put_bytes(out_, attachment.data.data(), attachment.data.size());
    put(out_, add_crc(0, std::span(out_).subspan(kMcapRecordHeadBytes)));
  });
  write_out(out_);
  ++attachment_count_;
  put_record(attachment_indexes_, kMcapAttachmentIndex, [&] {
    put(attachment_indexes_, start);
    put(attachment_indexes_, static_cast<std::uint64_t>(out_.size()));
    put(attachment_indexes_, attachment.log_time_ns);
    put(attachment_indexes_, attachment.create_time_ns);
    put(attachment_indexes_, static_cast<std::uint64_t>(attachment.data.size()));
    put(attachment_indexes_, std::string_view(attachment.name));
    put(attachment_indexes_, std::string_view(attachment.media_type));
  });
}

void McapWriter::write_metadata(const McapMetadata& metadata) {
  if (fd_ < 0) return;
  check_size(path_, "metadata record", metadata.name.size() + size_of(metadata.values));
  const std::uint64_t start = bytes_written_;
  out_.clear();
  put_record(out_, kMcapMetadata, [&] {
    put(out_, std::string_view(metadata.name));
    put(out_, metadata.values);
  });
  write_out(out_);
  ++metadata_count_;
  put_record(metadata_indexes_, kMcapMetadataIndex, [&] {
    put(metadata_indexes_, start);
    put(metadata_indexes_, static_cast<std::uint64_t>(out_.size()));
    put(metadata_indexes_, std::string_view(metadata.name));
  });
}

void McapWriter::flush() {
  if (fd_ < 0 || chunk_.empty()) return;
  const std::uint64_t start = bytes_written_;
  std::size_t compressed_size = 0;
  out_.clear();
  put_record(out_, kMcapChunk, [&] {
    put(out_, chunk_times_.first_ns);
    put(out_, chunk_times_.last_ns);
    put(out_, static_cast<std::uint64_t>(chunk_.size()));
    put(out_, add_crc(0, chunk_));
    put(out_, std::string_view("zstd"));
    put_with_length<std::uint64_t>(out_, [&] {
      const std::size_t at = out_.size();
      out_.resize(at + ZSTD_compressBound(chunk_.size()));
      compressed_size = ZSTD_compress2(static_cast<ZSTD_CCtx*>(compressor_.get()), &out_[at],
                                       out_.size() - at, chunk_.data(), chunk_.size());
      if (ZSTD_isError(compressed_size))
        throw std::bad_alloc();  // the only error when there is room enough
      out_.resize(at + compressed_size);
    });
  });
  const std::uint64_t chunk_length = out_.size();

  Bytes index_offsets;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].index.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    put(index_offsets, id);
    put(index_offsets, start + out_.size());
    put_record(out_, kMcapMessageIndex, [&] {
      put(out_, id);
      put_with_length<std::uint32_t>(
          out_, [&] { put_bytes(out_, channels_[i].index.data(), channels_[i].index.size()); });
    });
    channels_[i].index.clear();
  }
  write_out(out_);

  ++chunk_count_;
  put_record(chunk_indexes_, kMcapChunkIndex, [&] {
    put(chunk_indexes_, chunk_times_.first_ns);
    put(chunk_indexes_, chunk_times_.last_ns);
    put(chunk_indexes_, start);
    put(chunk_indexes_, chunk_length);
    put(chunk_indexes_, static_cast<std::uint32_t>(index_offsets.size()));
    put_bytes(chunk_indexes_, index_offsets.data(), index_offsets.size());
    put(chunk_indexes_, out_.size() - chunk_length);
    put(chunk_indexes_, std::string_view("zstd"));
    put(chunk_indexes_, static_cast<std::uint64_t>(compressed_size));
    put(chunk_indexes_, static_cast<std::uint64_t>(chunk_.size()));
  });
  chunk_.clear();
  chunk_times_ = {};
}

void McapWriter::close() {
  flush();
  if (fd_ < 0) return;
  Bytes statistics;
  put_record(statistics, kMcapStatistics, [&] {
    put(statistics, times_.messages);
    put(statistics, schema_count_);
    put(statistics, static_cast<std::uint32_t>(channels_.size()));
    put(statistics, attachment_count_);
    put(statistics, metadata_count_);
    put(statistics, chunk_count_);
    put(statistics, times_.first_ns);
    put(statistics, times_.last_ns);
    put_with_length<std::uint32_t>(statistics, [&] {
      for (std::size_t i = 0; i < channels_.size(); ++i) {
        put(statistics, static_cast<std::uint16_t>(i + 1));
        put(statistics, channels_[i].messages);
      }
    });
  });

  out_.clear();
  put_record(out_, kMcapDataEnd, [&] { put(out_, data_crc_); });
  const std::size_t summary_at = out_.size();
  Bytes offsets;
  const std::pair<McapOpcode, const Bytes&> groups[] = {{kMcapSchema, schema_records_},
                                                        {kMcapChannel, channel_records_},
                                                        {kMcapStatistics, statistics},
                                                        {kMcapChunkIndex, chunk_indexes_},
                                                        {kMcapAttachmentIndex, attachment_indexes_},
                                                        {kMcapMetadataIndex, metadata_indexes_}};
  for (const auto& group : groups) {
    if (group.second.empty()) continue;
    put_record(offsets, kMcapSummaryOffset, [&] {
      put(offsets, group.first);
      put(offsets, bytes_written_ + out_.size());
      put(offsets, static_cast<std::uint64_t>(group.second.size()));
    });
    put_bytes(out_, group.second.data(), group.second.size());
  }
  const std::uint64_t offsets_start = bytes_written_ + out_.size();
  put_bytes(out_, offsets.data(), offsets.size());
  put_record(out_, kMcapFooter, [&] {
    put(out_, bytes_written_ + summary_at);
    put(out_, offsets_start);
    put(out_, std::uint32_t{0});
  });
  // The CRC covers the summary and the footer up to the CRC itself, the record's length included.
  const std::uint32_t crc = add_crc(
      0, std::span(out_).subspan(summary_at, out_.size() - summary_at - sizeof(std::uint32_t)));
  std::memcpy(&out_[out_.size() - sizeof crc], &crc, sizeof crc);
  put_bytes(out_, kMcapMagic.data(), kMcapMagic.size());
  write_out(out_);
  if (::close(std::exchange(fd_, -1)) != 0) throw write_error(path_, errno, bytes_written_);
}

void McapWriter::write_out(std::span<const std::byte> bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(fd_, bytes.data() + done, bytes.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (written == 0 || errno != EINTR) {
      const int error = written == 0 ? ENOSPC : errno;
      // Cuts off what is not whole. If that fails, the reader still stops there.
      [[maybe_unused]] const int result = ::ftruncate(fd_, static_cast<off_t>(bytes_written_));
      give_up();
      throw write_error(path_, error, bytes_written_);
    }
  }
  bytes_written_ += bytes.size();
  data_crc_ = add_crc(data_crc_, bytes);
}

void McapWriter::give_up() noexcept {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

}  // namespace sandrunner
