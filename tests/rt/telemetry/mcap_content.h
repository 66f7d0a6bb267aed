// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mcap_sample.h"
#include "rt/telemetry/mcap/mcap_reader.h"
#include "tests/support/error_of.h"

namespace sandrunner {

struct OwnedMessage {
  McapMessage head;  ///< without its data
  std::string data;
};

/// Everything that a reader returns before its end or its error.
struct Content {
  std::vector<OwnedMessage> messages;
  std::vector<McapAttachment> attachments;
  std::vector<McapMetadata> metadata;
  std::map<std::uint16_t, McapSchema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  std::string library, error;
  bool complete = false;
};

inline void read_into(Content& content, McapReader& reader) {
  content.error = error_of([&] {
    while (const McapMessage* message = reader.next()) {
      content.messages.push_back(
          {*message, {reinterpret_cast<const char*>(message->data.data()), message->data.size()}});
    }
  });
  if (!content.error.empty()) {
    EXPECT_EQ(reader.next(), nullptr) << "after an error";
  }
  content.attachments = reader.attachments();
  content.metadata = reader.metadata();
  content.schemas = reader.schemas();
  content.channels = reader.channels();
  content.library = reader.profile() + " " + reader.library();
  content.complete = reader.complete();
}

inline Content read_bytes(const std::string& bytes) {
  Content content;
  std::istringstream stream(bytes);
  const std::string error = error_of([&] {
    McapReader reader(stream, "some.mcap");
    read_into(content, reader);
  });
  if (!error.empty()) content.error = error;
  return content;
}

inline Content read_path(const std::string& path) {
  Content content;
  McapReader reader(path);
  read_into(content, reader);
  return content;
}

/// Message `i` of the sample.
inline bool is_of_sample(const OwnedMessage& message, int i) {
  const std::uint64_t time_ns = kSampleStartNs + static_cast<std::uint64_t>(i) * 250'000;
  return message.head.channel_id == sample_channel_id(i) &&
         message.head.sequence == static_cast<std::uint32_t>(i / 3) &&
         message.head.log_time_ns == time_ns && message.head.publish_time_ns == time_ns - 1000 &&
         message.data == sample_data(i);
}

/// Expects the first messages of the sample.
inline bool is_start_of_sample(const Content& content) {
  int i = 0;
  for (const OwnedMessage& message : content.messages) {
    if (!is_of_sample(message, i++)) return false;
  }
  return true;
}

inline bool is_whole_sample(const Content& content, std::size_t messages) {
  return is_start_of_sample(content) && content.messages.size() == messages &&
         content.attachments.size() == 2 && content.attachments[0].data == "gain = 1.0\n" &&
         content.metadata.size() == 1 && content.metadata[0].values.size() == 2;
}

inline std::uint64_t number_at(const std::string& bytes, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Place and length of every top-level record of a type.
inline std::vector<std::pair<std::size_t, std::size_t>> records_of_type(const std::string& bytes,
                                                                        int opcode) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t at = 8; at + 9 < bytes.size();) {
    const std::size_t length = 9 + number_at(bytes, at + 1);
    if (bytes[at] == opcode) found.emplace_back(at, length);
    at += length;
  }
  return found;
}

/// In order, but for the length of its chunk: 60 MB.
inline std::string head_of_a_chunk_beyond_the_file() {
  const std::uint64_t stored = std::uint64_t{60} << 20, length = 16 + 8 + 4 + 4 + 4 + 8 + stored;
  const auto raw = [](const auto& number) {
    return std::string(reinterpret_cast<const char*>(&number), sizeof number);
  };
  return std::string(1, '\x06') + raw(length) + std::string(28, '\0') +
         std::string("\x04\0\0\0zstd", 8) + raw(stored);
}

}  // namespace sandrunner
