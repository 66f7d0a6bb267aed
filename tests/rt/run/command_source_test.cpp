// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/command_source.h"

#include <gtest/gtest.h>

#include "tests/rt/support.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

void expect_command(const VelocityCommand& command, double vx, double vy, double wz) {
  EXPECT_DOUBLE_EQ(command.vx_mps, vx);
  EXPECT_DOUBLE_EQ(command.vy_mps, vy);
  EXPECT_DOUBLE_EQ(command.wz_radps, wz);
}

TEST(CommandSourceTest, ConstantHoldsAtAllTimes) {
  const CommandSource command("1.5,-0.25,+2e-1");
  for (const double t_s : {0.0, 0.3, 1e6}) expect_command(command.at(t_s), 1.5, -0.25, 0.2);
  EXPECT_EQ(command.text(), "1.5,-0.25,+2e-1");
}

TEST(CommandSourceTest, ConstantMayHaveBlanks) {
  expect_command(CommandSource(" -1, 2 ,\t3").at(0.0), -1.0, 2.0, 3.0);
}

TEST(CommandSourceTest, MalformedConstantIsRefused) {
  for (const char* text :
       {"1,2", "1,2,3,4", "", "nan,0,0", "0,inf,0", "0,0,-infinity", "1;2;3", "1,,3", "1,2,",
        "1,2,3 4", "0x10,0,0", "1e999,0,0", "1,2,++3", "+-1,0,0", "."}) {
    expect_refused([&] { CommandSource{text}; }, {"--command: '" + std::string(text) + "'"});
  }
  expect_refused([] { CommandSource("20.1,0,0"); }, {"--command: 20.1, expected at most 20"});
  expect_refused([] { CommandSource("0,0,-21"); }, {"--command: -21"});
}

class CommandFileTest : public testing::Test {
 protected:
  CommandSource read(const std::string& content) {
    write_file(path_, content);
    return CommandSource(path_);
  }
  const TemporaryFolder folder_;
  const std::string path_ = folder_.path("command.csv");
};

TEST_F(CommandFileTest, InterpolatesBetweenRowsAndHoldsBeyondThem) {
  const CommandSource command = read("t_s,vx,vy,wz\n0.5,0,1,-1\n3.0,4,0,-1\n4,2,0,1\n");
  expect_command(command.at(0.0), 0.0, 1.0, -1.0);
  expect_command(command.at(0.5), 0.0, 1.0, -1.0);
  expect_command(command.at(1.75), 2.0, 0.5, -1.0);
  expect_command(command.at(3.0), 4.0, 0.0, -1.0);
  expect_command(command.at(3.75), 2.5, 0.0, 0.5);
  expect_command(command.at(4.0), 2.0, 0.0, 1.0);
  expect_command(command.at(1e9), 2.0, 0.0, 1.0);
  EXPECT_EQ(command.text(), path_);
}

TEST_F(CommandFileTest, TwoRowsOfOneTimeAreAJump) {
  const CommandSource command = read("t_s,vx,vy,wz\n0,1,0,0\n2,1,0,0\n2,3,0,0\n4,3,0,0\n");
  expect_command(command.at(1.999), 1.0, 0.0, 0.0);
  expect_command(command.at(2.0), 3.0, 0.0, 0.0);
}

TEST_F(CommandFileTest, TakesLineEndsOfBothKindsAndEmptyLines) {
  const CommandSource command = read("t_s,vx,vy,wz\r\n0, 1, 0, 0\r\n\n2,2,0,0");
  expect_command(command.at(1.0), 1.5, 0.0, 0.0);
}

TEST_F(CommandFileTest, RefusalNamesFileAndLine) {
  const struct {
    const char* content;
    const char* place;  ///< after the file's name
    const char* found;
  } cases[] = {
      {"", "", "no rows"},
      {"t_s,vx,vy,wz\n", "", "no rows"},
      {"t_s,vx,vy\n0,1,2\n", ":1", "'t_s,vx,vy'"},
      {"0,1,0,0\n", ":1", "'0,1,0,0'"},
      {"t_s,vx,vy,wz\n0,1,0\n", ":2", "'0,1,0'"},
      {"t_s,vx,vy,wz\n0,1,0,0,0\n", ":2", "'0,1,0,0,0'"},
      {"t_s,vx,vy,wz\n0,1,0,0\n1,x,0,0\n", ":3", "'1,x,0,0'"},
      {"t_s,vx,vy,wz\n\n0,nan,0,0\n", ":3", "'0,nan,0,0'"},
      {"t_s,vx,vy,wz\ninf,0,0,0\n", ":2", "'inf,0,0,0'"},
      {"t_s,vx,vy,wz\n0,1,0,0\n2,1,0,0\n1.5,1,0,0\n", ":4", "t_s 1.5 after 2"},
      {"t_s,vx,vy,wz\n0,0,30,0\n", ":2", "30, expected at most 20"},
      {"t_s,vx,vy,wz\n0 1 0 0\n", ":2", "'0 1 0 0'"},
      {"t_s,vx,vy,wz\n0,1,0,0\n \n", ":3", "' '"},
  };
  for (const auto& c : cases) expect_refused([&] { read(c.content); }, {path_ + c.place, c.found});
}

TEST_F(CommandFileTest, MissingFileIsRefused) {
  expect_refused([&] { CommandSource(folder_.path("absent.csv")); }, {"absent.csv", "nor a file"});
  expect_refused([&] { CommandSource(folder_.path("")); }, {"nor a file"});
}

}  // namespace
}  // namespace sandrunner
