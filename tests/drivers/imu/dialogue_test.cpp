// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/dialogue.h"

#include <gtest/gtest.h>

#include "drivers/imu/xsens.h"
#include "tests/drivers/imu/pty.h"

namespace sandrunner {
namespace {

TEST(DialogueTest, DataThatBeginBehindAnAnswerHaveTheTimeOfTheirFirstByte) {
  const Pty pty;
  SerialPort port(pty.path(), 921600);
  xsens::Parser parser;
  Dialogue<xsens::Parser> dialogue(port, parser);
  const xsens::Message question(xsens::kGoToMeasurement), answer(xsens::kGoToMeasurement + 1);
  const xsens::Message data(xsens::kSensorData, std::vector<std::uint8_t>(20));
  std::vector<std::uint8_t> sent(answer.bytes().begin(), answer.bytes().end());
  sent.insert(sent.end(), data.bytes().begin(), data.bytes().begin() + 10);

  const std::int64_t before_ns = clock_ns(CLOCK_MONOTONIC);
  pty.write(sent);
  ASSERT_TRUE(dialogue.ask(question.bytes(), 5000, [&](const xsens::MessageView& message) {
    return message.id == answer.id();
  }));
  const std::int64_t after_ns = clock_ns(CLOCK_MONOTONIC);
  int messages = 0;
  const auto look = [&](const xsens::MessageView& message) {
    ++messages;
    EXPECT_GE(message.first_byte_ns, before_ns);
    EXPECT_LE(message.first_byte_ns, after_ns);
  };
  parser.feed(data.bytes().subspan(10), after_ns + 1'000'000, look);
  EXPECT_EQ(messages, 1);
}

}  // namespace
}  // namespace sandrunner
