// SPDX-License-Identifier: BSD-3-Clause
// The server over real sockets.
#include "rt/telemetry/view/view_server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "rt/telemetry/view/view_rules.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/rt/telemetry/view/web_page.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

using Json = nlohmann::json;

RunRow row_at(std::uint64_t period) {
  RunRow row;
  row.t_s = static_cast<double>(period) / kPolicyHz;
  return row;
}

struct ViewServerTest : testing::Test {
  ViewServerTest() {
    for (std::uint64_t i = 0; i < 10; ++i) feed.add(row_at(i), {});
    const std::string url = server.url();
    port = std::stoi(url.substr(url.find(':', 6) + 1));
    key = url.substr(url.find("#key=") + 5);
  }
  std::string request(const std::string& head) {
    Client client(port);
    client.send(head);
    return client.rest().value_or("open");
  }
  std::string get(const std::string& target, const std::string& host = "127.0.0.1") {
    return request("GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  }
  std::string hello(const std::string& with_key) {
    return R"({"say":"hello","key":")" + with_key + "\"}";
  }

  std::atomic<int> interrupt{false};
  ViewFeed feed{RunScene{.robot = example_robot()}};
  ViewPace pace{interrupt};
  ViewServer server{0, {.feed = feed, .pace = &pace}};
  int port = 0;
  std::string key;
};

TEST_F(ViewServerTest, ThePageComesWithTheHeadersThatKeepOthersOut) {
  const std::string page = get("/");
  EXPECT_TRUE(page.starts_with("HTTP/1.1 200 ")) << page;
  EXPECT_NE(page.find("<!doctype html>"), std::string::npos);
  for (const auto& [name, value] : kViewHeaders) {
    EXPECT_NE(page.find(std::string(name) + ": " + std::string(value) + "\r\n"), std::string::npos);
  }
  EXPECT_EQ(page.find(key), std::string::npos);
  EXPECT_NE(get("/page.js").find("Content-Encoding: gzip"), std::string::npos);
}

TEST_F(ViewServerTest, WhatIsNoneOfItsBusinessIsRefused) {
  EXPECT_TRUE(get("/", "evil.example").starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(get("/../etc/passwd").starts_with("HTTP/1.1 404 "));
  EXPECT_TRUE(get("/?key=" + key).starts_with("HTTP/1.1 404 "));
  EXPECT_TRUE(request("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi")
                  .starts_with("HTTP/1.1 405 "));
  EXPECT_EQ(get("/" + std::string(kViewHeaderBytes, 'a')), "");
  EXPECT_EQ(request("\r\n\x01\x02\x03 nonsense\r\n\r\n"), "");
}

TEST_F(ViewServerTest, AHeaderInDripsEndsAfterItsTime) {
  const auto begin = std::chrono::steady_clock::now();
  Client client(port);
  client.send("GET / HTTP/1.1\r\nHost: local");
  EXPECT_EQ(client.rest(), "");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kViewHeaderTime + std::chrono::seconds(4));
}

TEST_F(ViewServerTest, SocketsThatAskForNothingLockNoPageOut) {
  WebPage open(port);
  open.say(hello(""));
  EXPECT_EQ(open.hear("hello").at("key"), false);
  std::vector<std::unique_ptr<Client>> silent;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 2 * kViewSockets; ++i) {
    silent.push_back(std::make_unique<Client>(port));
    silent.back()->send("GET / HTTP/1.1\r\nHost: local");
  }
  EXPECT_TRUE(get("/").starts_with("HTTP/1.1 200 "));
  EXPECT_TRUE(WebPage(port).answer.starts_with("HTTP/1.1 101 "));
  EXPECT_EQ(silent.front()->rest(), "");  // the oldest of them went
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kViewHeaderTime);
  open.say(R"({"say":"pause","on":true})");  // and no page that was there
  EXPECT_EQ(open.hear("refused").at("why"), "without the key this page only looks");
}

TEST_F(ViewServerTest, TheNinthPageIsRefused) {
  std::vector<std::unique_ptr<WebPage>> pages;
  for (const std::string& with : {std::string(), key}) {
    for (int i = 0; i < kViewPages; ++i) {
      pages.push_back(std::make_unique<WebPage>(port));
      pages.back()->say(hello(with));
      EXPECT_EQ(pages.back()->hear("hello").at("key"), !with.empty());
    }
    WebPage ninth(port);
    ninth.say(hello(with));
    EXPECT_EQ(ninth.close_code(), 1013);
  }
}

TEST_F(ViewServerTest, StrangersKeepNobodyOutWhoHasTheKey) {
  std::vector<std::unique_ptr<WebPage>> strangers;
  for (int i = 0; i < kViewPages; ++i) {
    strangers.push_back(std::make_unique<WebPage>(port));
    strangers.back()->say(hello(""));
    EXPECT_EQ(strangers.back()->hear("hello").at("key"), false);
  }
  std::vector<std::unique_ptr<WebPage>> silent;  // pages that say no hello
  for (int i = 0; i < 2 * kViewSockets; ++i) silent.push_back(std::make_unique<WebPage>(port));
  WebPage page(port);
  page.say(hello(key));
  EXPECT_EQ(page.hear("hello").at("key"), true);
  EXPECT_EQ(strangers.front()->close_code(), -1);  // the oldest went, at once
  strangers[1]->say(R"({"say":"pause","on":true})");
  EXPECT_EQ(strangers[1]->hear("refused").at("why"), "without the key this page only looks");
  for (int i = 0; i < 2 * kViewSockets; ++i) WebPage(port).say(hello(""));
  page.say(R"({"say":"pause","on":true})");
  for (Json state = page.hear("state"); state.at("paused") == false;) state = page.hear("state");
}

TEST_F(ViewServerTest, APageGetsHelloThenThePastThenTheState) {
  WebPage page(port);
  page.say(hello(""));
  const Message first = page.hear();
  ASSERT_EQ(first.kind, 1);
  const Json json = Json::parse(first.text);
  EXPECT_EQ(json.at("say"), "hello");
  EXPECT_EQ(json.at("key"), false);
  EXPECT_EQ(json.at("hello").at("robot"), "example");
  const Message frames = page.hear();
  EXPECT_EQ(frames.kind, 2);
  EXPECT_EQ(frames.text.size(), 8 + 10 * sizeof(RunRow));
  EXPECT_EQ(page.hear("state").at("paused"), false);
}

TEST_F(ViewServerTest, WhoHasNoKeyOrAWrongOneOnlyLooks) {
  for (const std::string& wrong : {std::string(), std::string(32, '0'), key + "0"}) {
    WebPage page(port);
    page.say(hello(wrong));
    EXPECT_EQ(page.hear("hello").at("key"), false);
    if (!wrong.empty()) {
      EXPECT_EQ(page.hear("refused").at("why"), "the key is not this run's");
    }
    page.say(R"({"say":"pause","on":true})");
    EXPECT_EQ(page.hear("refused").at("why"), "without the key this page only looks");
    EXPECT_FALSE(pace.status().paused);
  }
}

TEST_F(ViewServerTest, WhoHasTheKeySetsTheRobotsPace) {
  WebPage page(port);
  page.say(hello(key));
  EXPECT_EQ(page.hear("hello").at("key"), true);
  page.say(R"({"say":"pace","rate":0.5})");
  page.say(R"({"say":"pause","on":true})");
  for (Json state = page.hear("state"); state.at("paused") == false;) state = page.hear("state");
  EXPECT_EQ(pace.status().rate, 0.5);
  page.say(R"({"say":"pace","rate":400})");
  EXPECT_EQ(page.hear("refused").at("why"), "rate: 400, expected 0.05 to 4");
}

TEST_F(ViewServerTest, APageThatDoesNotKeepTheRulesIsSentAway) {
  const auto code = [&](std::string_view text, int kind = 1, bool greets = true) {
    WebPage page(port);
    if (greets) page.say(hello(key));
    page.say(text, kind);
    return page.close_code();
  };
  EXPECT_EQ(code("{}", 2), 1003);                                   // binary
  EXPECT_EQ(code(std::string(kViewMessageBytes + 1, ' ')), 1009);   // too long
  EXPECT_EQ(code(R"({"say":"pause","on":true})", 1, false), 1008);  // no hello
  WebPage page(port);
  page.say(hello(""));
  for (int i = 0; i < kViewMessagesPerSecond; ++i) page.say("{}");
  EXPECT_EQ(page.close_code(), 1008);
}

TEST_F(ViewServerTest, APageThatDoesNotReadLosesFramesAndDelaysNobody) {
  WebPage slow(port), page(port);
  slow.say(hello(""));
  page.say(hello(""));
  page.hear("state");
  // More than the kernel keeps for a page that does not read: 20,000 frames are 10 MB.
  std::uint64_t next = 10;
  const auto begin = std::chrono::steady_clock::now();
  for (; next < 20'000; ++next) feed.add(row_at(next), {});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  const double newest_s = static_cast<double>(next - 1) / kPolicyHz;
  double seen_s = 0.0;
  while (seen_s < newest_s) {
    const Message message = page.hear();
    ASSERT_NE(message.kind, -1);
    if (message.kind != 2) continue;
    RunRow last;
    std::memcpy(&last, message.text.data() + message.text.size() - sizeof last, sizeof last);
    seen_s = last.t_s;
  }
  EXPECT_DOUBLE_EQ(seen_s, newest_s);
}

TEST_F(ViewServerTest, ARunWithoutADeskTakesNoCommands) {
  WebPage page(port);
  page.say(hello(key));
  EXPECT_EQ(page.hear("hello").at("drive"), false);
  for (const char* order :
       {R"({"say":"drive","vx":1,"vy":0,"wz":0})", R"({"say":"request","name":"arm"})"}) {
    page.say(order);
    EXPECT_EQ(page.hear("refused").at("why"), "this run takes no commands from a page");
  }
}

TEST_F(ViewServerTest, APageIsOneOfTheOperators) {
  RemoteOperator op(1200);
  OperatorDesk desk(op, 60.0, nullptr);
  const ViewServer driven(0, {.feed = feed, .desk = &desk});
  const std::string url = driven.url();
  const int its_port = std::stoi(url.substr(url.find(':', 6) + 1));
  const std::string its_key = url.substr(url.find("#key=") + 5);
  WebPage page(its_port), other(its_port), looker(its_port);
  page.say(hello(its_key));
  other.say(hello(its_key));
  looker.say(hello(""));
  const auto refusal = [](WebPage& from, std::string_view order) {
    from.say(order);
    return from.hear("refused").at("why").get<std::string>();
  };
  constexpr std::string_view kForward = R"({"say":"drive","vx":0.5,"vy":0,"wz":0})";
  EXPECT_EQ(refusal(looker, kForward), "without the key this page only looks");
  EXPECT_EQ(refusal(page, R"({"say":"drive","vx":6,"vy":0,"wz":0})"),
            "a velocity of 6, 0 m/s, 0 rad/s is absurd");
  page.say(kForward);
  page.say(R"({"say":"request","name":"walk"})");  // answered behind the velocity
  EXPECT_EQ(page.hear("answer").at("accepted"), false);
  EXPECT_EQ(refusal(other, kForward), "another operator drives the robot");
  const OperatorId peer{1};
  EXPECT_EQ(desk.drive({}, 1, peer), CommandVerdict::kOtherPublisher);
  EXPECT_EQ(op.command(1).velocity.vx_mps, 0.5);
  const CommandCounts counts = desk.counts();
  EXPECT_EQ(counts.accepted, 1u);
  EXPECT_EQ(counts.absurd, 1u);
  EXPECT_EQ(counts.other_publisher, 2u);
}

struct FoxgloveTest : ViewServerTest {
  FoxgloveTest() {
    topics.begin(kExampleStart_ns);
    const std::string url = its_server.url();
    its_port = std::stoi(url.substr(url.find(':', 6) + 1));
    its_key = url.substr(url.find("#key=") + 5);
  }
  std::unique_ptr<WebPage> foxglove(const std::string& protocols = "foxglove.sdk.v1",
                                    const std::string& lines = "") {
    return std::make_unique<WebPage>(its_port, "/",
                                     "Sec-WebSocket-Protocol: " + protocols + "\r\n" + lines);
  }

  LiveTopics topics{example_robot()};
  ViewServer its_server{0, {.feed = feed, .topics = &topics}};
  int its_port = 0;
  std::string its_key;
};

TEST_F(FoxgloveTest, ItIsAnsweredInItsProtocolAndGetsWhatItSubscribesTo) {
  for (const std::string protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    const auto page = foxglove("x, " + protocol, "Origin: https://app.foxglove.dev\r\n");
    EXPECT_NE(page->answer.find("Sec-WebSocket-Protocol: " + protocol + "\r\n"), std::string::npos);
    EXPECT_EQ(Json::parse(page->hear().text).at("op"), "serverInfo");
    const Json channels = Json::parse(page->hear().text).at("channels");
    EXPECT_EQ(page->hear().text[0], 2);  // time
    const auto robot = std::ranges::find(channels, "/robot_description",
                                         [](const Json& channel) { return channel.at("topic"); });
    page->say(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":)" +
              robot->at("id").dump() + "}]}");
    const Message message = page->hear();
    EXPECT_EQ(message.kind, 2);
    EXPECT_EQ(message.text.substr(13), topics.said_once(RunTopic::kRobotDescription)->cdr);
  }
}

TEST_F(FoxgloveTest, OthersAreRefusedAndSoIsARunWithoutTopics) {
  const auto begins = [](const std::string& answer) { return answer.substr(0, 13); };
  EXPECT_EQ(begins(foxglove("mqtt")->answer), "HTTP/1.1 404 ");
  EXPECT_EQ(begins(foxglove("foxglove.sdk.v1", "Origin: https://evil.example\r\n")->answer),
            "HTTP/1.1 403 ");
  EXPECT_EQ(begins(WebPage(port, "/", "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n").answer),
            "HTTP/1.1 404 ");
}

TEST_F(FoxgloveTest, ItsPlacesAreThoseOfPagesWithoutTheKey) {
  std::vector<std::unique_ptr<WebPage>> sessions;
  for (int i = 0; i < kViewPages; ++i) {
    sessions.push_back(foxglove());
    EXPECT_EQ(Json::parse(sessions.back()->hear().text).at("op"), "serverInfo");
  }
  EXPECT_EQ(foxglove()->close_code(), 1013);
  WebPage page(its_port);
  page.say(hello(its_key));
  EXPECT_EQ(page.hear("hello").at("key"), true);
  EXPECT_EQ(sessions.front()->close_code(), -1);  // the oldest went
}

TEST_F(ViewServerTest, APortThatIsTakenIsSaidInOneLine) {
  EXPECT_EQ(
      error_of([&] { const ViewServer second(port, {.feed = feed}); }),
      "view.port: " + std::to_string(port) +
          " of 127.0.0.1: Address already in use, expected a port that is free, as any is with "
          "--set view.port=0");
}

TEST(ViewPaceTest, APauseHoldsTheTicksAndStepsLetSoManyPass) {
  std::atomic<int> interrupt{false};
  ViewPace pace(interrupt);
  pace.pause(true);
  std::atomic<int> ticks{0};
  const auto run = std::async(std::launch::async, [&] {
    while (!interrupt) {
      ++ticks;
      pace.wait();
    }
  });
  pace.step(100);
  while (ticks < 101) std::this_thread::yield();
  EXPECT_TRUE(pace.status().paused);
  EXPECT_EQ(ticks, 101);
  pace.step(1);
  while (ticks < 102) std::this_thread::yield();
  interrupt = true;
  run.wait();
  EXPECT_LE(ticks, 103);
}

}  // namespace
}  // namespace sandrunner
