// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/live_topics.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "rt/telemetry/mcap/mcap_reader.h"
#include "rt/telemetry/recording/recording_writer.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kTicks = 4080;

RunTopics only(RunTopic topic) { return RunTopics().set(static_cast<std::size_t>(topic)); }

std::vector<std::string> all_of(const LiveTopics& topics, RunTopic topic, std::uint64_t place = 0) {
  std::vector<std::string> messages;
  while (const auto message = topics.next(place, only(topic))) messages.push_back(message->cdr);
  return messages;
}

/// By topic, what a recording of `ticks` has.
std::map<std::string, std::vector<std::string>> recorded(const std::vector<TickRecord>& ticks) {
  const TemporaryFolder folder;
  const std::string path = folder.path("run.mcap");
  RecordingInfo info;
  info.robot = example_robot();
  info.start_time_ns = kExampleStart_ns;
  RecordingWriter writer(path, info);
  writer.write(ticks);
  writer.close();
  std::map<std::string, std::vector<std::string>> messages;
  McapReader reader(path);
  while (const McapMessage* message = reader.next()) {
    messages[reader.channels().at(message->channel_id).topic].emplace_back(
        reinterpret_cast<const char*>(message->data.data()), message->data.size());
  }
  return messages;
}

TEST(LiveTopicsTest, ATopicWithoutASubscriberIsNotEncoded) {
  LiveTopics topics(example_robot());
  topics.begin(kExampleStart_ns);
  topics.note(0, "push", "by hand");
  for (std::uint64_t i = 0; i < kTicks; ++i) topics.add(example_tick(i));
  EXPECT_EQ(topics.join(), 0u);
  topics.subscribe(RunTopic::kImu);
  topics.add(example_tick(kTicks));
  EXPECT_EQ(topics.join(), 1u);
  topics.unsubscribe(RunTopic::kImu);
  for (std::uint64_t i = 1; i < kTicks; ++i) topics.add(example_tick(kTicks + i));
  topics.end();
  EXPECT_EQ(topics.join(), 1u);
}

TEST(LiveTopicsTest, ASubscriberGetsTheBytesThatARecordingHas) {
  std::vector<TickRecord> ticks;
  for (std::uint64_t i = 0; i < kTicks; ++i) ticks.push_back(example_tick(i));
  auto expected = recorded(ticks);
  for (std::size_t i = 0; i < kNumRunTopics; ++i) {
    const auto topic = static_cast<RunTopic>(i);
    SCOPED_TRACE(run_topics()[i].name);
    LiveTopics topics(example_robot());
    topics.subscribe(topic);
    topics.begin(kExampleStart_ns);
    for (const TickRecord& tick : ticks) topics.add(tick);
    topics.end();
    std::vector<std::string> got = all_of(topics, topic);
    if (run_topics()[i].once) got.push_back(topics.said_once(topic)->cdr);
    EXPECT_EQ(got.empty(), topic == RunTopic::kStates);
    EXPECT_EQ(got, expected[run_topics()[i].name]);
  }
}

TEST(LiveTopicsTest, WhoComesLateGetsWhatWasSaidOnceAndOfTheRestWhatFollows) {
  LiveTopics topics(example_robot());
  EXPECT_FALSE(topics.said_once(RunTopic::kRobotDescription));
  topics.begin(kExampleStart_ns);
  topics.subscribe(RunTopic::kImu);
  for (std::uint64_t i = 0; i < kTicks; ++i) topics.add(example_tick(i));
  const std::uint64_t place = topics.join();
  EXPECT_TRUE(all_of(topics, RunTopic::kImu, place).empty());
  topics.add(example_tick(kTicks));
  EXPECT_EQ(all_of(topics, RunTopic::kImu, place).size(), 1u);
  EXPECT_EQ(topics.said_once(RunTopic::kRobotDescription)->time_ns,
            static_cast<std::uint64_t>(kExampleStart_ns));
}

TEST(LiveTopicsTest, AReaderThatFallsBehindGoesOnWithTheNewest) {
  LiveTopics topics(example_robot());
  topics.subscribe(RunTopic::kImu);
  topics.begin(kExampleStart_ns);
  const std::uint64_t steps = 2 * LiveTopics::kMostBehind;
  for (std::uint64_t i = 0; i < steps; ++i) topics.add(example_tick(i * kTicksPerPolicyStep));
  std::uint64_t place = 1;
  const auto newest = topics.next(place, only(RunTopic::kImu));
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->time_ns, topics.time_ns());
  EXPECT_FALSE(topics.next(place, only(RunTopic::kImu)));
}

}  // namespace
}  // namespace sandrunner
