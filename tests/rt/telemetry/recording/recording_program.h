// SPDX-License-Identifier: BSD-3-Clause
// The programs that write and replay recordings, and recordings with something changed.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rt/loop/tick_fields.h"
#include "rt/telemetry/recording/recorder.h"
#include "rt/telemetry/recording/recording_file.h"
#include "tests/rt/telemetry/mcap_content.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text_match.h"

namespace sandrunner {

/// Place of a field in the words of a tick, e.g. of "joint_position_rad[7]".
inline std::size_t word_named(const std::string& name) {
  std::size_t word = 0;
  while (tick_word_name(word) != name) ++word;
  return word;
}

/// Reads a recording for its ticks; `tick` as RecordingVisitor's.
inline RecordingContents read_ticks(const std::string& path,
                                    std::function<bool(const TickRecord&)> tick = {}) {
  RecordingVisitor visitor;
  visitor.tick = std::move(tick);
  return read_recording(path, visitor);
}

/// The recording again, all checksums right, with other facts or ticks.
inline void rewrite(const std::string& from, const std::string& to,
                    const std::function<void(RecordingInfo&)>& change_info,
                    const std::function<void(TickRecord&)>& change_tick) {
  std::optional<RecordingWriter> writer;
  std::vector<TickRecord> ticks;
  RecordingVisitor visitor;
  visitor.begin = [&](const RecordingInfo& found) {
    RecordingInfo info = found;
    if (change_info) change_info(info);
    writer.emplace(to, info);
  };
  visitor.tick = [&](const TickRecord& found) {
    TickRecord record = found;
    if (change_tick) change_tick(record);
    ticks.push_back(record);
    if (ticks.size() == kTicksPerMessage) {
      writer->write(ticks);
      ticks.clear();
    }
    return true;
  };
  read_recording(from, visitor);
  writer->write(ticks);
  writer->close();
}

/// The same with bits of one word of one tick flipped.
inline void flip(const std::string& from, const std::string& to, std::uint64_t tick,
                 std::size_t word, std::uint64_t mask) {
  rewrite(from, to, {}, [&](TickRecord& record) {
    if (record.input.sensors.tick != tick) return;
    auto words = std::bit_cast<TickWords>(record);
    words[word] ^= mask;
    record = std::bit_cast<TickRecord>(words);
  });
}

/// Places and sizes of the chunks in a file.
inline std::vector<std::pair<std::size_t, std::size_t>> chunks_of(const std::string& bytes) {
  return records_of_type(bytes, 0x06);
}

class RecordingProgramTest : public testing::Test {
 protected:
  /// Runs `sandrunner` or `sandrunner-replay`; returns the exit code.
  int run(const std::string& program, const std::string& arguments,
          const std::string& before = "") {
    const Ended ended = run_shell(before + "'" + program + "' " + arguments);
    output_ = ended.out + ended.err;
    return ended.code;
  }
  /// As if the disk had room for 600 kB a file (blocks of 512 bytes): the policy's attachment alone
  /// takes 430.
  int run_on_full_disk(const std::string& program, const std::string& arguments) {
    return run(program, arguments, "trap '' XFSZ && ulimit -f 1172 && ");
  }
  const std::string& output() const { return output_; }

  /// Damages the recording's third chunk: its ticks are lost and said to be, all others agree, but
  /// for `next` at most, behind the damage, that are said not to be compared.
  void expect_damage_costs_its_own_span(const std::string& path, std::uint64_t ticks,
                                        std::uint64_t next = 0) {
    const std::string whole = read_file(path), damaged = folder_.path("damaged.mcap");
    const auto chunks = chunks_of(whole);
    ASSERT_GT(chunks.size(), 4u);
    // In its compressed bytes, and in its length: then where the next record begins is not known.
    for (const std::size_t at : {chunks[2].first + 200, chunks[2].first + 3}) {
      std::string bytes = whole;
      bytes[at] ^= 0x10;
      write_file(damaged, bytes);
      const std::string plots = folder_.path("plots");
      EXPECT_EQ(run(SANDRUNNER_REPLAY, damaged + " --plot '" + plots + "'"), 2);
      const std::string text = output();
      const auto spans = matches_in(text, "LOST by damage: tick ([0-9]+) .* to ([0-9]+) ");
      ASSERT_EQ(spans.size(), 1u) << text;
      const std::uint64_t lost = std::stoull(spans[0][2]) - std::stoull(spans[0][1]) + 1;
      EXPECT_GT(lost, 40u);
      EXPECT_LT(lost, 2200u);  // half a second, the most that a chunk holds
      const auto left_out = matches_in(text, "([0-9]+) ticks behind lost ones");
      const std::uint64_t not_compared = left_out.empty() ? 0 : std::stoull(left_out[0][1]);
      EXPECT_LE(not_compared, next) << text;
      EXPECT_NE(text.find(std::to_string(ticks - lost - not_compared) + " ticks and "),
                std::string::npos)
          << text;
      EXPECT_NE(text.find("every bit agrees\n"), std::string::npos) << text;
      EXPECT_NE(text.find("sandrunner-replay: " + damaged), std::string::npos) << text;
      EXPECT_TRUE(std::filesystem::exists(plots + "/run.html"));
      std::filesystem::remove_all(plots);
    }
  }

  const TemporaryFolder folder_;  ///< of the recordings

 private:
  std::string output_;
};

}  // namespace sandrunner
