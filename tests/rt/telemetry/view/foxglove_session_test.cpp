// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/foxglove_session.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/rt/telemetry/example_tick.h"

namespace sandrunner {
namespace {

using Json = nlohmann::json;

template <typename T>
T number(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

struct FoxgloveSessionTest : testing::Test {
  FoxgloveSessionTest() {
    topics.begin(kExampleStart_ns);
    info = Json::parse(session.next().bytes);
    advertised = Json::parse(session.next().bytes);
    for (const Json& channel : advertised.at("channels")) {
      ids[channel.at("topic")] = channel.at("id");
    }
  }
  std::string subscription(const std::string& topic, unsigned id) {
    return Json{{"op", "subscribe"},
                {"subscriptions", {{{"id", id}, {"channelId", ids.at(topic)}}}}}
        .dump();
  }
  /// What the session answers to this; empty: nothing.
  std::string answer(const std::string& text) {
    data();  // what is there without it
    EXPECT_FALSE(session.take(text));
    const ViewSession::Outgoing out = session.next();
    if (out.bytes.empty()) return {};
    EXPECT_TRUE(out.text);
    const Json json = Json::parse(out.bytes);
    EXPECT_EQ(json.at("op"), "status");
    EXPECT_EQ(json.at("level"), 1);
    return json.at("message");
  }
  void walk(std::uint64_t ticks) {
    for (std::uint64_t i = 0; i < ticks; ++i) topics.add(example_tick(tick++));
  }
  /// The next message with data; empty: there is none. Its time has been said before.
  std::string data() {
    for (;;) {
      const ViewSession::Outgoing out = session.next();
      EXPECT_FALSE(out.text);
      if (out.bytes.empty()) return {};
      if (out.bytes[0] == 1) {
        EXPECT_GE(now_ns, number<std::uint64_t>(out.bytes, 5));
        return out.bytes;
      }
      EXPECT_EQ(out.bytes[0], 2);
      EXPECT_EQ(out.bytes.size(), 9u);
      EXPECT_GT(number<std::uint64_t>(out.bytes, 1), now_ns);
      now_ns = number<std::uint64_t>(out.bytes, 1);
    }
  }

  LiveTopics topics{example_robot()};
  FoxgloveSession session{topics, "run 1"};
  Json info, advertised;
  std::map<std::string, unsigned> ids;
  std::uint64_t tick = 0, now_ns = 0;
};

TEST_F(FoxgloveSessionTest, ItSaysWhoItIsAndOffersTheTopicsOfARecording) {
  EXPECT_EQ(info.at("op"), "serverInfo");
  EXPECT_EQ(info.at("capabilities"), Json::array({"time"}));
  EXPECT_EQ(info.at("sessionId"), "run 1");
  EXPECT_EQ(advertised.at("op"), "advertise");
  EXPECT_EQ(advertised.at("channels").size(), kNumRunTopics - 1);
  EXPECT_FALSE(ids.contains(kStatesTopic));
  for (const Json& channel : advertised.at("channels")) {
    EXPECT_EQ(channel.at("encoding"), "cdr");
    EXPECT_FALSE(channel.at("schema").get<std::string>().empty());
  }
}

TEST_F(FoxgloveSessionTest, WhatIsSubscribedToComesUnderTheClientsNumberUntilItIsNot) {
  EXPECT_EQ(answer(subscription("/imu/data", 77)), "");
  EXPECT_EQ(answer(subscription("/odom", 5)), "");
  walk(1);
  std::map<unsigned, std::string> got;
  for (std::string bytes = data(); !bytes.empty(); bytes = data()) {
    EXPECT_EQ(number<std::uint64_t>(bytes, 5), static_cast<std::uint64_t>(kExampleStart_ns));
    got[number<std::uint32_t>(bytes, 1)] = bytes.substr(13);
  }
  ASSERT_EQ(got.size(), 2u);
  std::uint64_t first = 0;
  EXPECT_EQ(got[77], topics.next(first, RunTopics().set(ids["/imu/data"]))->cdr);
  EXPECT_EQ(answer(R"({"op":"unsubscribe","subscriptionIds":[77,5]})"), "");
  walk(200);
  EXPECT_EQ(data(), "");
  EXPECT_EQ(topics.join(), 2u);  // nothing more was encoded
}

TEST_F(FoxgloveSessionTest, AMessageThatWaitsForItsTimeIsNotSentToNobody) {
  EXPECT_EQ(answer(subscription("/imu/data", 1)), "");
  walk(1 + kTicksPerPolicyStep);
  EXPECT_EQ(number<std::uint32_t>(data(), 1), 1u);
  ASSERT_EQ(session.next().bytes[0], 2);
  EXPECT_FALSE(session.take(R"({"op":"unsubscribe","subscriptionIds":[1]})"));
  EXPECT_EQ(data(), "");
}

TEST_F(FoxgloveSessionTest, TheRobotsDescriptionComesOncePerSubscription) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(session.take(subscription("/robot_description", 3)));
    const std::string description = data();
    ASSERT_GT(description.size(), 13u);
    EXPECT_EQ(description.substr(13), topics.said_once(RunTopic::kRobotDescription)->cdr);
    EXPECT_EQ(data(), "");
    EXPECT_EQ(answer(R"({"op":"unsubscribe","subscriptionIds":[3]})"), "");
  }
}

TEST_F(FoxgloveSessionTest, TimeGoesOnWithoutAnySubscription) {
  walk(1);
  EXPECT_EQ(data(), "");
  const std::uint64_t before = now_ns;
  walk(kControlHz / 10);
  EXPECT_EQ(data(), "");
  EXPECT_GT(now_ns, before);
}

TEST_F(FoxgloveSessionTest, WhatItDoesNotUnderstandIsAnsweredInOneWarning) {
  const char* const kOnlyShows = "op: expected subscribe or unsubscribe: this server only shows";
  for (const char* text : {"", "{", "[]", "7", "{}", R"({"op":7})", R"({"op":"advertise"})",
                           R"({"op":"setParameters","parameters":[]})"}) {
    EXPECT_EQ(answer(text), kOnlyShows) << text;
  }
  const std::string deep = std::string(2000, '[') + std::string(2000, ']');
  EXPECT_EQ(answer(R"({"op":)" + deep + "}"), kOnlyShows);
  EXPECT_EQ(answer(R"({"op":"subscribe"})"), "subscriptions: expected an array");
  EXPECT_EQ(answer(R"({"op":"unsubscribe","subscriptionIds":{"a":1}})"),
            "subscriptionIds: expected an array");
  const auto subscribe = [&](const std::string& what) {
    return answer(R"({"op":"subscribe","subscriptions":[)" + what + "]}");
  };
  const char* const kNumbers = "subscriptions: expected numbers id and channelId in each";
  for (const char* what :
       {"1", "{}", R"({"id":1})", R"({"id":-1,"channelId":3})", R"({"id":1.5,"channelId":3})",
        R"({"id":4294967296,"channelId":3})", "1,2,3,4,5,6,7,8,9"}) {
    EXPECT_EQ(subscribe(what), kNumbers) << what;
  }
  EXPECT_EQ(subscribe(R"({"id":1,"channelId":10})"), "channelId: 10 was not advertised");
  EXPECT_EQ(subscribe(R"({"id":1,"channelId":1})"), "channelId: 1 was not advertised");
  EXPECT_EQ(subscribe(R"({"id":1,"channelId":3})"), "");
  EXPECT_EQ(subscribe(R"({"id":1,"channelId":4})"), "id: 1 is in use");
  EXPECT_EQ(subscribe(R"({"id":2,"channelId":3})"), "channelId: 3 has a subscription");
  EXPECT_EQ(answer(R"({"op":"unsubscribe","subscriptionIds":[9]})"),
            "subscriptionIds: expected numbers of subscriptions");
  EXPECT_TRUE(session.listens());
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(session.take("{}"));
  EXPECT_FALSE(session.listens());
}

TEST(FoxgloveSessionsTest, TheTopicsOfASessionThatEndsAreNotEncodedAnyMore) {
  LiveTopics topics(example_robot());
  topics.begin(kExampleStart_ns);
  {
    FoxgloveSession session(topics, "run");
    EXPECT_FALSE(session.take(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})"));
    for (std::uint64_t i = 0; i < kTicksPerMessage; ++i) topics.add(example_tick(i));
    EXPECT_EQ(topics.join(), 1u);
  }
  for (std::uint64_t i = 0; i < kTicksPerMessage; ++i) topics.add(example_tick(i));
  topics.end();
  EXPECT_EQ(topics.join(), 1u);
}

}  // namespace
}  // namespace sandrunner
