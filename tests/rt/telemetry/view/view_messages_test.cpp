// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_messages.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

constexpr const char* kNone =
    "say: expected hello, drive, request, pace, pause, step, push, set_on_legs or terrain";

/// Why it is nonsense; empty: it is not.
std::string why(std::string_view text) {
  const PageMessage message = parse_page_message(text);
  const auto* nonsense = std::get_if<PageNonsense>(&message);
  return nonsense ? nonsense->why : "";
}

TEST(ViewMessagesTest, WhatAPageMaySayIsUnderstood) {
  EXPECT_EQ(std::get<PageHello>(parse_page_message(R"({"say":"hello","key":"ab"})")).key, "ab");
  const auto drive =
      std::get<PageDrive>(parse_page_message(R"({"say":"drive","vx":1.5,"vy":0,"wz":-2})"));
  EXPECT_EQ(drive.velocity.vx_mps, 1.5);
  EXPECT_EQ(drive.velocity.wz_radps, -2.0);
  EXPECT_EQ(std::get<PageRequest>(parse_page_message(R"({"say":"request","name":"stand"})")).name,
            "stand");
  EXPECT_EQ(std::get<PagePace>(parse_page_message(R"({"say":"pace","rate":0.25})")).rate, 0.25);
  EXPECT_TRUE(std::get<PagePause>(parse_page_message(R"({"say":"pause","on":true})")).on);
  EXPECT_EQ(std::get<PageStep>(parse_page_message(R"({"say":"step","ticks":40})")).ticks, 40);
  EXPECT_EQ(
      std::get<PagePush>(parse_page_message(R"({"say":"push","direction":-2})")).direction_rad,
      -2.0);
  EXPECT_TRUE(
      std::holds_alternative<PageSetOnLegs>(parse_page_message(R"({"say":"set_on_legs"})")));
  const WantedGround ground =
      std::get<PageTerrain>(
          parse_page_message(R"({"say":"terrain","preset":"grass","set":{"drag":3}})"))
          .ground;
  EXPECT_EQ(ground.preset, "grass");
  EXPECT_EQ(ground.set, (GroundSettings{{"drag", 3.0}}));
}

TEST(ViewMessagesTest, EverythingElseIsRefusedAndSaidWhy) {
  for (const char* text :
       {"", "[]", "1", "null", "{", R"({"say":"hello","key":"a"} x)", "{'say':'pause'}",
        R"({"say":"hello","key":"a",})", "\xff", R"({"say":"drive","vx":NaN,"vy":0,"wz":0})",
        R"({"say":"drive","vx":1e999,"vy":0,"wz":0})"}) {
    EXPECT_EQ(why(text), "expected a JSON object") << text;
  }
  EXPECT_EQ(why("{}"), kNone);
  EXPECT_EQ(why(R"({"say":7})"), kNone);
  EXPECT_EQ(why(R"({"say":"shutdown"})"), kNone);
  EXPECT_EQ(why(R"({"say":"drive","vx":1,"vy":0})"), "wz: missing");
  EXPECT_EQ(why(R"({"say":"drive","vx":"1","vy":0,"wz":0})"), "vx: expected a number");
  EXPECT_EQ(why(R"({"say":"drive","vx":1,"vy":0,"wz":0,"vz":0})"), "expected 4 keys");
  EXPECT_EQ(why(R"({"say":"pause","on":1})"), "on: expected true or false");
  EXPECT_EQ(why(R"({"say":"pace","rate":0})"), "rate: 0, expected 0.05 to 4");
  EXPECT_EQ(why(R"({"say":"pace","rate":4.01})"), "rate: 4.01, expected 0.05 to 4");
  EXPECT_EQ(why(R"({"say":"step","ticks":0})"), "ticks: 0, expected 1 to 4000");
  EXPECT_EQ(why(R"({"say":"step","ticks":1.5})"), "ticks: 1.5, expected a whole number");
  EXPECT_EQ(why(R"({"say":"push"})"), "direction: missing");
  EXPECT_EQ(why(R"({"say":"push","direction":90})"),
            "direction: 90, expected -6.283185307179586 to 6.283185307179586");
  EXPECT_EQ(why(R"({"say":"terrain","preset":"","set":[]})"), "set: expected an object");
  EXPECT_EQ(why(R"({"say":"terrain","preset":"","set":{"drag":"1"}})"),
            "set: expected finite numbers");
  EXPECT_EQ(why(R"({"say":"set_on_legs","now":true})"), "expected 1 keys");
}

}  // namespace
}  // namespace sandrunner
