// SPDX-License-Identifier: BSD-3-Clause
// The reader reads what the writer writes, whole, truncated or damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <utility>

#include "mcap_bytes.h"
#include "mcap_content.h"
#include "mcap_sample.h"
#include "rt/telemetry/mcap/mcap_writer.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

std::string sample_bytes(const TemporaryFolder& folder, int messages, int flush_every) {
  const std::string path = folder.path("sample.mcap");
  McapWriter writer(path);
  write_sample(writer, messages, flush_every);
  writer.close();
  return read_file(path);
}

TEST(McapTest, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.mcap");
  constexpr int kMessages = 12'000;
  {
    McapWriter writer(path);
    write_sample(writer, kMessages, 0);
    writer.close();
    EXPECT_EQ(writer.bytes_written(), std::filesystem::file_size(path));
  }
  const Content content = read_path(path);
  EXPECT_EQ(content.error, "");
  EXPECT_TRUE(content.complete);
  EXPECT_TRUE(is_whole_sample(content, kMessages));
  EXPECT_EQ(content.library, "ros2 sandrunner " SANDRUNNER_VERSION);
  ASSERT_EQ(content.schemas.size(), 2U);
  EXPECT_EQ(content.schemas.at(2),
            (McapSchema{2, "sandrunner::Tick", "omgidl", "struct Tick { long long tick; };\n"}));
  ASSERT_EQ(content.channels.size(), 3U);
  EXPECT_EQ(
      content.channels.at(2),
      (McapChannel{2, 2, "/tick", "cdr", {{"offered_qos_profiles", ""}, {"rate_hz", "4000"}}}));
  EXPECT_EQ(content.attachments[0].name, "config.toml");
  EXPECT_EQ(content.attachments[0].media_type, "application/toml");
  EXPECT_EQ(content.attachments[0].create_time_ns, 5U);
  EXPECT_EQ(content.attachments[1].data, "");
  EXPECT_EQ(content.metadata[0].name, "build");
  // 12 000 messages are 2.6 MB: the writer has ended chunks by itself.
  EXPECT_EQ(records_of_type(read_file(path), 0x06).size(), 3U);
}

TEST(McapTest, CutFileReadsUpToTheLastWholeChunk) {
  const TemporaryFolder folder;
  constexpr std::size_t kPerChunk = 25;
  const std::string bytes = sample_bytes(folder, 1000, kPerChunk);
  const auto chunks = records_of_type(bytes, 0x06);
  ASSERT_EQ(chunks.size(), 40U);
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = random() % bytes.size();
    const auto whole = std::count_if(chunks.begin(), chunks.end(), [&](const auto& chunk) {
      return chunk.first + chunk.second <= size;
    });
    const Content content = read_bytes(bytes.substr(0, size));
    EXPECT_EQ(content.error, "") << size;
    EXPECT_FALSE(content.complete) << size;
    EXPECT_EQ(content.messages.size(), static_cast<std::size_t>(whole) * kPerChunk) << size;
    EXPECT_TRUE(is_start_of_sample(content)) << size;
  }
}

TEST(McapTest, FlippedBitInsideAChunkIsFound) {
  const TemporaryFolder folder;
  const std::string bytes = sample_bytes(folder, 200, 50);
  const auto chunks = records_of_type(bytes, 0x06);
  constexpr std::size_t kFieldsBytes = 9 + 28 + 8 + 8;  // before the compressed records
  std::mt19937 random(2);
  int by_chunk = 0;
  for (int i = 0; i < 500; ++i) {
    const auto [at, length] = chunks[random() % chunks.size()];
    std::string damaged = bytes;
    damaged[at + kFieldsBytes + random() % (length - kFieldsBytes)] ^=
        static_cast<char>(1U << (random() % 8));
    const Content content = read_bytes(damaged);
    EXPECT_TRUE(is_start_of_sample(content));
    // A bit that zstd does not use changes no message; the CRC of the whole data still finds it.
    const bool in_chunk =
        content.error.find("some.mcap: record at byte " + std::to_string(at) + ": found") == 0;
    EXPECT_TRUE(in_chunk || content.error.find("of the data section") != std::string::npos)
        << content.error;
    by_chunk += in_chunk;
  }
  EXPECT_GT(by_chunk, 490);
}

TEST(McapTest, DamageIsSkippedToTheNextChunk) {
  const TemporaryFolder folder;
  constexpr std::size_t kPerChunk = 50;
  const std::string bytes = sample_bytes(folder, 200, kPerChunk);
  const auto chunks = records_of_type(bytes, 0x06);
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    const std::size_t chosen = random() % chunks.size();
    std::string damaged = bytes;
    // Also in its length, where the next record cannot be found by it.
    damaged[chunks[chosen].first + 1 + random() % (chunks[chosen].second - 1)] ^=
        static_cast<char>(1U << (random() % 8));
    std::istringstream stream(damaged);
    McapReader reader(stream, "some.mcap");
    std::size_t read = 0;
    for (bool more = true; more;) {
      try {
        while (reader.next()) ++read;
        more = !reader.complete() && reader.skip_damage();
      } catch (const InputError&) {
        more = reader.skip_damage();
      }
    }
    EXPECT_GE(read, 200 - kPerChunk) << i;
  }
}

TEST(McapTest, ManyLengthsBeyondTheFileAreSkippedOneByOne) {
  constexpr int kHeads = 60000;
  const TemporaryFolder folder;
  std::string bytes = sample_bytes(folder, 60, 12);
  bytes.resize(bytes.size() / 2);
  for (int i = 0; i < kHeads; ++i) bytes += head_of_a_chunk_beyond_the_file();
  std::istringstream stream(bytes);
  McapReader reader(stream, "some.mcap");
  int skipped = 0;
  for (bool more = true; more;) {
    try {
      while (reader.next()) {
      }
    } catch (const InputError&) {
    }
    more = reader.skip_damage();
    skipped += more;
  }
  EXPECT_GE(skipped, kHeads - 1);
}

TEST(McapTest, MutatedFilesEndInAnErrorOrAsCutAndNeverGiveWrongMessages) {
  const TemporaryFolder folder;
  const std::string sample = sample_bytes(folder, 60, 12);
  std::string records = schema(1, "a/msg/B") + channel(1, 1, "/b");
  for (unsigned i = 0; i < 5; ++i) records += message(1, 10 + i, "data");
  const std::string open = file_with_chunk(records);  // only the parser can stop it
  std::mt19937 random(3);
  int errors = 0, cut = 0, right = 0;
  for (int i = 0; i < 5000; ++i) {
    const bool is_sample = i % 2 == 0;
    std::string bytes = is_sample ? sample : open;
    for (std::size_t n = 1 + random() % 3; n > 0; --n) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          bytes[at] ^= static_cast<char>(1U << (random() % 8));
          break;
        case 1:
          bytes[at] = static_cast<char>(random());
          break;
        case 2:
          bytes.erase(at, 1 + random() % 20);
          break;
        default:
          bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 40));
      }
    }
    const Content content = read_bytes(bytes);
    errors += !content.error.empty();
    cut += !content.complete && content.error.empty();
    EXPECT_EQ(content.error.find('\n'), std::string::npos);
    if (!is_sample) continue;
    for (const OwnedMessage& message : content.messages) {
      const std::uint64_t since_start_ns = message.head.log_time_ns - kSampleStartNs;
      EXPECT_TRUE(is_of_sample(message, static_cast<int>(since_start_ns / 250'000))) << i;
      ++right;
    }
    EXPECT_TRUE(!content.complete || is_whole_sample(content, 60)) << i;
  }
  EXPECT_GT(errors, 3500);
  EXPECT_GT(cut, 20);
  EXPECT_GT(right, 50'000);
}

TEST(McapTest, BytesThatAreNotAnMcapFileAreRefusedWithTheCause) {
  const std::string start = kMagic + header("by hand");
  const std::string declared = schema(1, "a/msg/B") + channel(1, 1, "/b");
  const std::string attachment =
      number(0, 16) + text("a") + text("b") + number(1, 8) + "x" + number(12345, 4);
  const std::string crc_records = declared + message(1, 5, "data");
  const std::pair<std::string, std::string> cases[] = {
      {"PK\3\4 zip", "found other bytes, expected the beginning of an MCAP file"},
      {kMagic + schema(1, "a"), "found type 0x03, expected the header once"},
      {start + header("again"), "found type 0x01, expected the header once"},
      {start + record(0, ""), "found type 0, expected"},
      {start + record(0x03, "abc"), "found 1 bytes left in it, expected a field of 4"},
      {start + channel(1, 1, "/b"), "found a channel of schema 1, expected the schema"},
      {start + declared + channel(1, 1, "/c"), "found two channels with the id 1"},
      {start + schema(1, "a") + schema(1, "b"), "found two schemas with the id 1"},
      {start + message(1, 5, ""), "found a message of channel 1, expected the channel"},
      {start + number(6, 1) + number(1ULL << 40, 8), "found a length of 1099511627776 bytes"},
      {start + chunk(1ULL << 40, 0, "", ""), "found a chunk of 1099511627776 bytes, expected at"},
      {start + chunk(60U << 20, 0, "zstd", "abc"), "found a chunk of 62914560 bytes compressed"},
      {start + chunk(100, 0, "zstd", "not a frame"), "found a chunk that zstd refuses"},
      {start + chunk(5, 0, "", "abc"), "found 3 bytes in a chunk, expected 5"},
      {start + chunk(3, 0, "lz4", "abc"), "found a chunk compressed with 'lz4', expected zstd"},
      {start + chunk(crc_records.size(), 99, "", crc_records), "of the chunk, expected"},
      {file_with_chunk("\5"), "found 0 bytes left in it, expected a field of 8"},
      {file_with_chunk(record(0x06, "")), "found type 0x06 in a chunk"},
      {start + record(0x05, std::string(21, '\0')),
       "found 7 bytes left in it, expected a field of 8"},
      {start + record(0x09, attachment), "of the attachment, expected"},
      {start + record(0x0C, text("m") + text(text("k") + text("") + text("k") + text(""))),
       "found a key twice in a map"},
      {start + record(0x0F, number(1, 4)), "of the data section, expected"},
      {start + record(0x02, number(0, 20)), "expected the end of the data before it"},
      {start + ending(start) + "x", "found more bytes after its end"},
  };
  for (const auto& [bytes, expected] : cases) {
    const Content content = read_bytes(bytes);
    EXPECT_EQ(content.error.find("some.mcap: record at byte "), 0U) << content.error;
    EXPECT_NE(content.error.find(expected), std::string::npos)
        << content.error << "\nexpected: " << expected;
  }
  const TemporaryFolder folder;
  std::string damaged_summary = sample_bytes(folder, 10, 0);
  damaged_summary[damaged_summary.size() - 45] ^=
      1;  // after it come a footer of 29 bytes and 8 of magic
  EXPECT_NE(read_bytes(damaged_summary).error.find("of the summary, expected"), std::string::npos);
  EXPECT_EQ(read_bytes("").error, "");  // killed before its first byte
  const Content good = read_bytes(file_with_chunk(crc_records));
  EXPECT_EQ(good.error, "");
  EXPECT_TRUE(good.complete);
  ASSERT_EQ(good.messages.size(), 1U);
  EXPECT_EQ(good.messages[0].data, "data");
}

}  // namespace
}  // namespace sandrunner
