// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_rules.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

int status(ViewRequest request) { return judge(request).status; }

TEST(ViewRulesTest, ThePageIsServedUnderEveryNameOfThisComputerAndAnyPort) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:8765", "localhost:9", "[::1]:65535", "[::1]"}) {
    EXPECT_EQ(status({"GET", "/", host}), 200) << host;
  }
  EXPECT_EQ(judge({"GET", "/page.js", "localhost"}).file, "page.js.gz");
  EXPECT_EQ(judge({"GET", "/page.css", "localhost"}).file, "page.css");
}

TEST(ViewRulesTest, AnotherHostIsRefused) {
  for (const char* host : {"", "evil.example", "evil.example:8765", "127.0.0.1.evil.example",
                           "localhost.", "[::1]8765", "127.0.0.1:", "127.0.0.1:8765.evil.example",
                           "127.0.0.2", "LOCALHOST@evil", "localhost:1234567"}) {
    EXPECT_EQ(status({"GET", "/", host}), 403) << host;
  }
}

TEST(ViewRulesTest, OnlyTheThreeNamesAreThereAndOnlyToGet) {
  for (const char* target : {"/../page.html", "/page.html", "//", "/?key=1", "/page.js?", "", "*",
                             "http://127.0.0.1/", "/live", "/page.js.gz", "/unpack.js"}) {
    EXPECT_EQ(status({"GET", target, "localhost"}), 404) << target;
  }
  for (const char* method : {"POST", "HEAD", "PUT", "OPTIONS", "get", "CONNECT"}) {
    EXPECT_EQ(status({method, "/", "localhost"}), 405) << method;
  }
}

TEST(ViewRulesTest, OnlyTheServersOwnPageGetsALiveConnection) {
  const auto live = [](const char* origin, const char* target = "/live") {
    return status({"GET", target, "127.0.0.1:8765", origin, true});
  };
  EXPECT_EQ(live("http://127.0.0.1:8765"), 101);
  for (const char* origin : {"", "null", "https://127.0.0.1:8765", "http://127.0.0.1:8766",
                             "http://127.0.0.1", "http://localhost:8765", "https://evil.example",
                             "http://127.0.0.1:8765.evil.example", "file://"}) {
    EXPECT_EQ(live(origin), 403) << origin;
  }
  EXPECT_EQ(live("http://127.0.0.1:8765", "/live?key=1"), 404);
  EXPECT_EQ(live("http://127.0.0.1:8765", "/"), 404);
}

TEST(ViewRulesTest, FoxgloveComesFromThisComputerOrFromItsOwnPage) {
  const auto verdict = [](std::string_view origin, std::string_view protocols = "foxglove.sdk.v1",
                          bool topics = true) {
    return judge({"GET", "/", "127.0.0.1:8765", origin, true, protocols, topics});
  };
  for (const char* origin : {"", "file://", "https://app.foxglove.dev", "http://localhost:8080",
                             "http://127.0.0.1", "http://[::1]:9"}) {
    EXPECT_EQ(verdict(origin).status, 101) << origin;
  }
  for (const char* origin :
       {"null", "https://evil.example", "https://app.foxglove.dev.evil.example",
        "https://app.foxglove.dev:444", "http://app.foxglove.dev", "https://localhost",
        "http://localhost.evil.example", "file:///home/me/page.html", "https://foxglove.dev"}) {
    EXPECT_EQ(verdict(origin).status, 403) << origin;
  }
  EXPECT_EQ(verdict("", "foxglove.websocket.v1").protocol, "foxglove.websocket.v1");
  EXPECT_EQ(verdict("", " a ,foxglove.websocket.v1 , foxglove.sdk.v1").protocol, "foxglove.sdk.v1");
  for (const char* protocols : {"", ",", "foxglove", "foxglove.sdk.v10", "foxglove.sdk.v1x, b"}) {
    EXPECT_EQ(verdict("", protocols).status, 404) << protocols;
  }
  EXPECT_EQ(verdict("", "foxglove.sdk.v1", false).status, 404);
  EXPECT_EQ(judge({"GET", "/", "evil.example", "", true, "foxglove.sdk.v1", true}).status, 403);
  EXPECT_EQ(judge({"POST", "/", "localhost", "", true, "foxglove.sdk.v1", true}).status, 405);
}

TEST(ViewRulesTest, AKeyHas128BitsAndIsAnotherOneEveryTime) {
  const std::string key = make_view_key();
  EXPECT_EQ(key.size(), 32u);
  EXPECT_EQ(key.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(key, make_view_key());
  EXPECT_TRUE(same_key(key, std::string(key)));
  EXPECT_FALSE(same_key(key, key.substr(1)));
  EXPECT_FALSE(same_key(key, ""));
  std::string other = key;
  other.front() = 'x';
  EXPECT_FALSE(same_key(key, other));
}

TEST(ViewRulesTest, The201stMessageOfASecondIsTooMuch) {
  MessageRate rate;
  const MessageRate::Time now{std::chrono::hours(1)};
  for (int i = 0; i < kViewMessagesPerSecond; ++i) ASSERT_TRUE(rate.allows(now));
  EXPECT_FALSE(rate.allows(now + std::chrono::milliseconds(999)));
  EXPECT_TRUE(rate.allows(now + std::chrono::seconds(1)));
}

}  // namespace
}  // namespace sandrunner
