// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/serial_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "tests/drivers/imu/pty.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const std::string& device) {
  return error_of([&] { const SerialPort port(device, 115200); });
}

TEST(SerialPortTest, PassesEveryByteBothWays) {
  const Pty pty;
  SerialPort port(pty.path(), 921600);
  std::array<std::uint8_t, 256> all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);

  port.write(all);
  std::vector<std::uint8_t> there;
  while (there.size() < all.size()) {
    const auto bytes = pty.read(2000);
    ASSERT_FALSE(bytes.empty());
    there.insert(there.end(), bytes.begin(), bytes.end());
  }
  EXPECT_TRUE(std::equal(all.begin(), all.end(), there.begin(), there.end()));

  pty.write(all);
  std::vector<std::uint8_t> here;
  while (here.size() < all.size()) {
    port.wait_readable(2000);
    std::array<std::uint8_t, 100> bytes;
    const int count = port.read(bytes);
    ASSERT_GT(count, 0);
    here.insert(here.end(), bytes.begin(), bytes.begin() + count);
  }
  EXPECT_TRUE(std::equal(all.begin(), all.end(), here.begin(), here.end()));
}

TEST(SerialPortTest, SetsAnySpeed) {
  const Pty pty;
  SerialPort port(pty.path(), 921600);
  EXPECT_EQ(pty.baud(), 921600U);
  port.set_baud(123456);
  EXPECT_EQ(pty.baud(), 123456U);
}

TEST(SerialPortTest, EmptyLineAnswersAtOnceAndAGoneOneSaysSo) {
  Pty pty;
  SerialPort port(pty.path(), 115200);
  std::array<std::uint8_t, 16> bytes;
  EXPECT_EQ(port.read(bytes), 0);
  pty.unplug();
  EXPECT_EQ(port.read(bytes), -1);
  EXPECT_THROW(port.write(bytes), InputError);
}

TEST(SerialPortTest, WhatCameBeforeItWasOpenedIsThrownAway) {
  const Pty pty;
  SerialPort port(pty.path(), 115200);
  pty.write(std::array<std::uint8_t, 3>{1, 2, 3});
  port.wait_readable(2000);
  port.set_baud(921600);
  std::array<std::uint8_t, 16> bytes;
  EXPECT_EQ(port.read(bytes), 0);
}

TEST(SerialPortTest, SecondOpenerIsRefusedUntilTheFirstIsGone) {
  const Pty pty;
  {
    const SerialPort port(pty.path(), 115200);
    EXPECT_THAT(refusal(pty.path()), AllOf(HasSubstr(pty.path()), HasSubstr("in use")));
  }
  EXPECT_EQ(refusal(pty.path()), "");
}

TEST(SerialPortTest, RefusalsNameTheDeviceAndTheReason) {
  const TemporaryFolder folder;
  const std::string file = folder.path("file");
  std::ofstream(file) << "text";
  EXPECT_EQ(refusal(file), "serial line " + file + ": is not a serial line");
  EXPECT_THAT(refusal("/dev/null"), HasSubstr("/dev/null: is not a serial line"));
  EXPECT_THAT(refusal(folder.path("ttyUSB7")), HasSubstr("ttyUSB7: does not exist"));
  EXPECT_THAT(refusal(testing::TempDir()), HasSubstr("can't be opened: Is a directory"));
}

TEST(SerialPortTest, LineOfOthersIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "root may open everything";
  const TemporaryFolder folder;
  const std::string file = folder.path("file");
  std::ofstream(file) << "text";
  std::filesystem::permissions(file, std::filesystem::perms::none);
  EXPECT_THAT(refusal(file), HasSubstr("no right to read and write it"));
}

}  // namespace
}  // namespace sandrunner
