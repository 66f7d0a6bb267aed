// SPDX-License-Identifier: BSD-3-Clause
// What `sandrunner --settings` prints is complete, and the README has it.
#include "rt/run/settings_reference.h"

#include <fstream>
#include <sstream>

#include "rt/run/process_config.h"
#include "sim/robot/embedded.h"
#include "tests/support/program_test.h"

namespace sandrunner {
namespace {

/// Whether a line of the reference begins with this key.
bool lists(const std::string& key) {
  static const std::string kReference = settings_reference();
  return kReference.find("\n| " + key + " ") != std::string::npos;
}

class SettingsReferenceTest : public ProgramTest {
 protected:
  SettingsReferenceTest() : ProgramTest(SANDRUNNER_PROGRAM) {}
};

TEST_F(SettingsReferenceTest, TheReadmeHasWhatTheProgramPrints) {
  std::stringstream readme;
  readme << std::ifstream(SANDRUNNER_RT_README).rdbuf();
  ASSERT_EQ(run("--settings"), 0);
  EXPECT_EQ(error(), "");
  EXPECT_GT(output().size(), 10000u);
  EXPECT_NE(readme.str().find(output()), std::string::npos)
      << "rt/README.md, \"All settings\": replace the tables by the output of sandrunner "
         "--settings";
}

TEST_F(SettingsReferenceTest, EveryKeyOfARunIsListed) {
  const std::string folder = SANDRUNNER_HARDWARE_EXAMPLES;
  for (const std::string& file :
       {folder + "/mit.toml", folder + "/damiao.toml", folder + "/moteus.toml",
        std::string(SANDRUNNER_UNITREE_EXAMPLE)}) {
    ConfigTree tree;
    tree.add_file(file);
    tree.set("terrain.patch=[{from_x_m=1.0}]");
    std::istringstream effective(read_process_config(tree, nullptr).effective);
    std::string table;
    int keys = 0;
    for (std::string line; std::getline(effective, line);) {
      const std::string key = line.substr(0, line.find(" = "));
      if (line.ends_with("= [")) {
        table = key + "[].";
      } else if (line.starts_with("  {")) {
        for (std::size_t at = 3; at < line.size();) {
          const std::size_t end = line.find(" = ", at);
          if (end == std::string::npos) break;
          const std::string inner = line.substr(at, end - at);
          EXPECT_TRUE(lists(table + inner) || lists("terrain." + inner)) << table << inner;
          const std::size_t next = line.find(", ", end);
          at = next == std::string::npos ? line.size() : next + 2;
        }
      } else if (line != "]") {
        EXPECT_TRUE(lists(key)) << key;
        ++keys;
      }
    }
    EXPECT_GT(keys, 100) << file;
  }
}

TEST_F(SettingsReferenceTest, EveryKeyOfARobotsFileIsListed) {
  std::istringstream file{std::string(embedded_robot_file("raibo.toml"))};
  std::string table;
  int keys = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("[")) table = line.substr(1, line.find(']') - 1) + ".";
    const std::size_t end = line.find(" = ");
    if (line.starts_with("#") || end == std::string::npos) continue;
    EXPECT_TRUE(lists(table + line.substr(0, end))) << table << line;
    ++keys;
  }
  EXPECT_GT(keys, 25);
}

}  // namespace
}  // namespace sandrunner
