// SPDX-License-Identifier: BSD-3-Clause
// The program with --view.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/rt/telemetry/view/web_page.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

using Json = nlohmann::json;

struct Address {
  int port = 0;
  std::string key;
};

/// The program with its standard error in a file.
std::vector<std::string> viewed(const std::string& arguments, const std::string& errors) {
  return {"sh", "-c", "exec " SANDRUNNER_PROGRAM " --view " + arguments + " 2>" + errors};
}

/// Waits until it has said where to look.
Address address_in(const std::string& errors) {
  std::string said;
  while (said.find('\n') == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::ostringstream text;
    text << std::ifstream(errors).rdbuf();
    said = text.str();
  }
  const std::size_t port = said.find("127.0.0.1:"), key = said.find("#key=");
  if (port == std::string::npos || key == std::string::npos) return {};
  return {std::stoi(said.substr(port + 10)), said.substr(key + 5, 32)};
}

/// Everything in a summary but how fast the computer was.
Json figures(const std::string& file) {
  Json json = Json::parse(read_file(file));
  json.erase("realtime_factor");
  return json;
}

class ViewedRobotTest : public testing::TestWithParam<std::string> {};

TEST_P(ViewedRobotTest, ARunThatIsLookedAtHeldAndSteppedIsTheSameToTheBit) {
  const TemporaryFolder folder;
  const std::string run = "--robot " + GetParam() + " --start walk --duration 1 --out ";
  ASSERT_EQ(run_shell(SANDRUNNER_PROGRAM " " + run + folder.path("plain")).code, 0);
  ChildProcess program(
      viewed(run + folder.path("viewed") + " --set view.port=0", folder.path("errors")));
  const Address address = address_in(folder.path("errors"));
  ASSERT_NE(address.port, 0);
  WebPage page(address.port);
  page.say(R"({"say":"hello","key":")" + address.key + "\"}");
  for (const char* order : {R"({"say":"pause","on":true})", R"({"say":"step","ticks":100})",
                            R"({"say":"pace","rate":0.1})", R"({"say":"pause","on":false})",
                            R"({"say":"pace","rate":4})"}) {
    page.say(order);
  }
  while (page.hear("state").at("ended") == false) {
  }
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().code, 0) << program.wait();
  EXPECT_EQ(figures(folder.path("viewed/summary.json")),
            figures(folder.path("plain/summary.json")));
  EXPECT_EQ(read_file(folder.path("viewed/run.csv")), read_file(folder.path("plain/run.csv")));
}

INSTANTIATE_TEST_SUITE_P(Robot, ViewedRobotTest, testing::Values("raibo", "go2"),
                         [](const auto& param_info) { return param_info.param; });

TEST(ViewProgramTest, ARunThatIsTouchedIsRecordedWithWhatWasDoneToItAndReplays) {
  const TemporaryFolder folder;
  ChildProcess program(
      viewed("--start walk --duration 600 --set view.port=0 --record " + folder.path("recording"),
             folder.path("errors")));
  const Address address = address_in(folder.path("errors"));
  ASSERT_NE(address.port, 0);
  WebPage page(address.port);
  page.say(R"({"say":"hello","key":")" + address.key + "\"}");
  page.say(R"({"say":"push","direction":0})");
  page.say(R"({"say":"terrain","preset":"grass","set":{"friction":0.7}})");
  Json state = page.hear("state");
  while (state.at("ground").at("name") != "grass") state = page.hear("state");
  const double then_s = state.at("t_s");
  while (page.hear("state").at("t_s") < then_s + 0.1) {
  }
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().code, 0);
  const Ended replay = run_shell(SANDRUNNER_REPLAY " " + folder.path("recording/run.mcap"));
  EXPECT_EQ(replay.code, 0) << replay.err;
  EXPECT_NE(replay.out.find(" s): push: 0.5 m/s towards 0 degrees\n"), std::string::npos);
  EXPECT_NE(replay.out.find(" s): terrain: grass friction=0.7\n"), std::string::npos);
  EXPECT_NE(replay.out.find("every bit agrees"), std::string::npos) << replay.out;
}

TEST(ViewProgramTest, APortThatIsTakenEndsItBeforeAnythingMoves) {
  const TemporaryFolder folder;
  ChildProcess first(viewed("--set view.port=0", folder.path("errors")));
  const Address address = address_in(folder.path("errors"));
  const Ended second =
      run_shell(SANDRUNNER_PROGRAM " --view --set view.port=" + std::to_string(address.port));
  EXPECT_EQ(second.code, 2);
  EXPECT_NE(second.err.find("Address already in use"), std::string::npos);
}

}  // namespace
}  // namespace sandrunner
