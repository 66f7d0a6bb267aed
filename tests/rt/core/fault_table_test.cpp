// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "rt/core/faults.h"
#include "rt/core/mode_machine.h"
#include "rt/core/warnings.h"

namespace sandrunner {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

const std::filesystem::path kRoot = SANDRUNNER_ROOT;

std::string modes_text(ModeSet modes) {
  if (modes == kAlways) return "all";
  if (modes == kMoving) return "all but passive";
  std::string text;
  for (std::uint64_t m = 0; m < 64; ++m) {
    if ((modes >> m & 1) == 0) continue;
    if (!text.empty()) text += ", ";
    text += mode_name(static_cast<Mode>(m));
  }
  return text;
}

TEST(FaultTableTest, StandsInTheReadmeAsItIsInTheCode) {
  std::string table =
      "| fault | what is wrong | from | in modes | within |\n|---|---|---|---|---|\n";
  for (const FaultRow& row : kFaultTable) {
    table += std::string("| `") + row.name + "` | " + row.meaning + " | " + row.sensor + " | " +
             modes_text(row.modes) + " | " + row.within + " |\n";
  }
  EXPECT_NE(text_of(kRoot / "rt/core/README.md").find(table), std::string::npos)
      << "rt/core/README.md should have:\n"
      << table;
}

TEST(FaultTableTest, WarningsStandInTheReadmeAsTheyAreInTheCode) {
  std::string table = "| warning | first limit | second limit |\n|---|---|---|\n";
  for (const WarningRow& row : kWarningTable) {
    table += std::string("| `") + row.name + "` | " + row.meaning + " | " + row.second + " |\n";
  }
  EXPECT_NE(text_of(kRoot / "rt/core/README.md").find(table), std::string::npos)
      << "rt/core/README.md should have:\n"
      << table;
}

TEST(HazardTest, EveryFaultAndEveryWarningHasAHazard) {
  const std::string hazards = text_of(kRoot / "rt/core/HAZARDS.md");
  const auto expect = [&](const std::string& name) {
    EXPECT_NE(hazards.find('`' + name + '`'), std::string::npos) << name;
  };
  for (const FaultRow& row : kFaultTable) expect(row.name);
  for (const WarningRow& row : kWarningTable) expect(row.name);
}

TEST(HazardTest, EveryTestThatIsNamedAsEvidenceExists) {
  std::string sources;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "tests")) {
    if (entry.path().extension() == ".cpp") sources += text_of(entry.path());
  }
  const std::string hazards = text_of(kRoot / "rt/core/HAZARDS.md");
  const std::regex name("`([A-Za-z]+Test)\\.([A-Za-z0-9]+)`");
  int found = 0;
  for (std::sregex_iterator at(hazards.begin(), hazards.end(), name), end; at != end; ++at) {
    EXPECT_NE(sources.find((*at)[1].str() + ", " + (*at)[2].str() + ")"), std::string::npos)
        << at->str();
    ++found;
  }
  EXPECT_GT(found, 15);
}

}  // namespace
}  // namespace sandrunner
