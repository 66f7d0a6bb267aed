// SPDX-License-Identifier: BSD-3-Clause
// The bytes of a file, and what is left of it when the writer cannot finish it.
#include "rt/telemetry/mcap/mcap_writer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zstd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "mcap_bytes.h"
#include "mcap_content.h"
#include "mcap_sample.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(McapWriterTest, WritesTheSpecifiedBytesAroundAnAttachment) {
  const TemporaryFolder folder;
  const std::string path = folder.path("tiny.mcap");
  McapWriter writer(path);
  writer.write_attachment(
      {.log_time_ns = 1, .create_time_ns = 2, .name = "a", .media_type = "b/c", .data = "xyz"});
  writer.close();

  const std::string start = kMagic + header("sandrunner " SANDRUNNER_VERSION);
  const std::string fields =
      number(1, 8) + number(2, 8) + text("a") + text("b/c") + number(3, 8) + "xyz";
  const std::string attachment = record(0x09, fields + number(crc(fields), 4));
  const std::string data_end = record(0x0F, number(crc(start + attachment), 4));
  const std::string statistics =
      record(0x0B, number(0, 8) + number(0, 2) + number(0, 4) + number(1, 4) + number(0, 4) +
                       number(0, 4) + number(0, 8) + number(0, 8) + number(0, 4));
  const std::string index =
      record(0x0A, number(start.size(), 8) + number(attachment.size(), 8) + number(1, 8) +
                       number(2, 8) + number(3, 8) + text("a") + text("b/c"));
  const std::size_t summary_at = start.size() + attachment.size() + data_end.size();
  const std::string summary =
      statistics + index +
      record(0x0E, number(0x0B, 1) + number(summary_at, 8) + number(statistics.size(), 8)) +
      record(0x0E,
             number(0x0A, 1) + number(summary_at + statistics.size(), 8) + number(index.size(), 8));
  const std::string footer = number(0x02, 1) + number(20, 8) + number(summary_at, 8) +
                             number(summary_at + statistics.size() + index.size(), 8);
  EXPECT_EQ(read_file(path), start + attachment + data_end + summary + footer +
                                 number(crc(summary + footer), 4) + kMagic);
}

TEST(McapWriterTest, WritesTheSpecifiedBytesOfAChunkAndItsIndex) {
  const TemporaryFolder folder;
  const std::string path = folder.path("chunk.mcap");
  McapWriter writer(path);
  const std::uint16_t schema_id = writer.add_schema("a/msg/B", "ros2msg", "int32 x\n");
  writer.add_channel(schema_id, "/b", "cdr", {{"k", "v"}});
  const std::string data = "\1\2\3\4";
  const auto write = [&](std::uint64_t time_ns) {
    writer.write_message({.channel_id = 1,
                          .sequence = 7,
                          .log_time_ns = time_ns,
                          .publish_time_ns = time_ns - 1,
                          .data = std::as_bytes(std::span(data))});
  };
  write(30);
  write(20);
  writer.flush();

  const std::string declared = schema(1, "a/msg/B") + channel(1, 1, "/b");
  const std::string records = message(1, 30, data) + message(1, 20, data);
  const std::string start = kMagic + header("sandrunner " SANDRUNNER_VERSION) + declared;
  const std::string bytes = read_file(path);
  const auto [at, length] = records_of_type(bytes, 0x06).at(0);
  ASSERT_EQ(at, start.size());
  const std::string fields = number(20, 8) + number(30, 8) + number(records.size(), 8) +
                             number(crc(records), 4) + text("zstd");
  EXPECT_EQ(bytes.substr(at + 9, fields.size()), fields);
  const std::size_t stored_at = at + 9 + fields.size() + 8;
  const std::size_t stored_size = number_at(bytes, stored_at - 8);
  EXPECT_EQ(stored_at + stored_size, at + length);
  std::string unpacked(records.size() + 1, '\0');
  unpacked.resize(
      ZSTD_decompress(unpacked.data(), unpacked.size(), bytes.data() + stored_at, stored_size));
  EXPECT_EQ(unpacked, records);
  EXPECT_EQ(bytes.substr(at + length),
            record(0x07, number(1, 2) + number(32, 4) + number(30, 8) + number(0, 8) +
                             number(20, 8) + number(message(1, 30, data).size(), 8)));
  EXPECT_EQ(bytes.substr(0, at), start);

  // The next chunk starts afresh.
  write(50);
  writer.flush();
  const std::string longer = read_file(path);
  const auto [second_at, second_length] = records_of_type(longer, 0x06).at(1);
  EXPECT_EQ(second_at, bytes.size());
  EXPECT_EQ(longer.substr(second_at + 9, 16), number(50, 8) + number(50, 8));
  EXPECT_EQ(longer.substr(second_at + second_length),
            record(0x07, number(1, 2) + number(16, 4) + number(50, 8) + number(0, 8)));
}

TEST(McapWriterTest, ChunkEndsAtOneMebibyteAndOnFlush) {
  const TemporaryFolder folder;
  McapWriter writer(folder.path("run.mcap"));
  write_sample_start(writer);
  const std::uint64_t start = writer.bytes_written();
  writer.flush();  // nothing to write
  EXPECT_EQ(writer.bytes_written(), start);
  std::size_t size = 0;
  for (int i = 0; size < (1U << 20); ++i) {
    ASSERT_EQ(writer.bytes_written(), start) << size;
    write_sample_message(writer, i);
    size += sample_data(i).size() + 31;
  }
  EXPECT_GT(writer.bytes_written(), start);
}

TEST(McapWriterTest, KilledProcessLosesOnlyWhatWasNotFlushed) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.mcap");
  const auto write_and_die = [&] {
    McapWriter writer(path);
    write_sample_start(writer);
    for (int i = 0; i < 150; ++i) {
      write_sample_message(writer, i);
      if (i == 99) writer.flush();
    }
    ::kill(::getpid(), SIGKILL);
  };
  ASSERT_EXIT(write_and_die(), testing::KilledBySignal(SIGKILL), "");
  const Content content = read_path(path);
  EXPECT_EQ(content.error, "");
  EXPECT_FALSE(content.complete);
  EXPECT_EQ(content.messages.size(), 100U);
  EXPECT_TRUE(is_start_of_sample(content));
  EXPECT_EQ(content.attachments.size(), 1U);
}

TEST(McapWriterTest, WriterThatIsNotClosedLeavesACutFileWithAllMessages) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.mcap");
  {
    McapWriter writer(path);
    write_sample(writer, 100, 40);
  }
  const Content content = read_path(path);
  EXPECT_EQ(content.error, "");
  EXPECT_FALSE(content.complete);
  EXPECT_TRUE(is_whole_sample(content, 100));
}

TEST(McapWriterTest, FileThatCannotBeOpenedIsNamed) {
  EXPECT_EQ(error_of([] { const McapWriter writer("/no/such/folder/run.mcap"); }),
            "/no/such/folder/run.mcap: cannot be written (No such file or directory), expected a "
            "path for an MCAP");
  EXPECT_EQ(error_of([] { const McapWriter writer("/dev/full"); }),
            "/dev/full: cannot be written (No space left on device), its first 0 bytes are kept");
  EXPECT_EQ(error_of([] { const McapReader reader("/no/such/run.mcap"); }),
            "/no/such/run.mcap: cannot be read (No such file or directory), expected an MCAP file");
  EXPECT_EQ(error_of([] { const McapReader reader("/"); }),
            "/: cannot be read (not a regular file), expected an MCAP file");
}

/// No file of this process may grow beyond `bytes`: a write there fails, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(McapWriterTest, FullDiskIsOneErrorAndTheFileSoFarIsRead) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.mcap");
  std::uint64_t size = 0;
  int errors = 0;
  {
    const FileSizeLimit limit(30'000);
    McapWriter writer(path);
    write_sample_start(writer);
    for (int i = 0; i < 4000; ++i) {
      try {
        write_sample_message(writer, i);
        if (i % 50 == 49) writer.flush();
      } catch (const InputError& error) {
        ++errors;
        size = writer.bytes_written();
        EXPECT_EQ(error.what(), path + ": cannot be written (File too large), its first " +
                                    std::to_string(size) + " bytes are kept");
      }
    }
    writer.close();
    EXPECT_EQ(writer.bytes_written(), size);
  }
  EXPECT_EQ(errors, 1);
  EXPECT_EQ(std::filesystem::file_size(path), size);
  const Content content = read_path(path);
  EXPECT_EQ(content.error, "");
  EXPECT_FALSE(content.complete);
  EXPECT_TRUE(is_start_of_sample(content));
  EXPECT_GT(content.messages.size(), 0U);
  EXPECT_EQ(content.messages.size() % 50, 0U);
}

TEST(McapWriterTest, WrongCallsAreRefusedAndTheFileGoesOn) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.mcap");
  McapWriter writer(path);
  write_sample_start(writer);
  const std::string big(kMcapMaxPayloadBytes + 1, 'x');
  McapMessage message;
  message.channel_id = 4;
  EXPECT_EQ(error_of([&] { writer.write_message(message); }),
            path + ": found a message of channel 4, expected 1 to 3");
  message.channel_id = 1;
  message.data = std::as_bytes(std::span(big));
  EXPECT_EQ(error_of([&] { writer.write_message(message); }),
            path + ": found a message of 62914561 bytes, expected at most 62914560");
  EXPECT_EQ(error_of([&] { writer.add_channel(3, "/x", "cdr", {}); }),
            path + ": found schema 3 for topic /x, expected at most 2");
  write_sample_message(writer, 0);
  writer.close();
  writer.close();
  write_sample_message(writer, 1);  // after the end: nothing
  const Content content = read_path(path);
  EXPECT_TRUE(content.complete);
  EXPECT_EQ(content.messages.size(), 1U);
}

}  // namespace
}  // namespace sandrunner
