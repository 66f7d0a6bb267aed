// SPDX-License-Identifier: BSD-3-Clause
// The model of the mode machine (tests/models) rests on the tables of the code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "rt/core/faults.h"
#include "rt/core/mode_machine.h"

namespace sandrunner {
namespace {

constexpr int kNumModes = 6;

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string mode_macro(Mode mode) { return upper(mode_name(mode)); }

std::string event_macro(Event event) {
  for (const RequestRow& row : kRequestTable) {
    if (row.event == event) return "REQUEST_" + upper(row.name);
  }
  switch (event) {
    case Event::kStoodUp:
      return "STOOD_UP";
    case Event::kStopped:
      return "STOPPED";
    case Event::kLowered:
      return "LOWERED";
    case Event::kFault:
      return "FAULT_FOUND";
    default:
      return "UNNAMED";  // a new event, which this function has to name
  }
}

std::string define(const std::string& name, std::uint64_t value) {
  return "#define " + name + " " + std::to_string(value) + "\n";
}

/// What promela needs of kTransitions, kRequestTable and the mode sets of kFaultTable.
std::string mode_table_promela() {
  std::string text =
      "// SPDX-License-Identifier: BSD-3-Clause\n"
      "// Made from kTransitions and kRequestTable (rt/core/mode_machine.h) and kFaultTable\n"
      "// (rt/core/faults.h). ModeTableTest compares it with them and says how to renew it.\n\n";
  for (int m = 0; m < kNumModes; ++m) text += define(mode_macro(static_cast<Mode>(m)), m);
  text += "\n";
  for (int e = 0; e < kNumEvents; ++e) text += define(event_macro(static_cast<Event>(e)), e);
  text += define("NO_EVENT", kNumEvents);

  text += "\ninline next_mode(from, event, to) {\n  if\n";
  std::set<std::pair<Mode, Mode>> edges;
  for (const Transition& t : kTransitions) {
    text += "  :: from == " + mode_macro(t.from) + " && event == " + event_macro(t.event) +
            " -> to = " + mode_macro(t.to) + "\n";
    edges.insert({t.from, t.to});
  }
  text += "  :: else -> to = from\n  fi\n}\n\n#define IS_EDGE(from, to) (false";
  for (const auto& [from, to] : edges) {
    text += " \\\n  || ((from) == " + mode_macro(from) + " && (to) == " + mode_macro(to) + ")";
  }
  text += ")\n\ninline any_request(event) {\n  if\n";
  for (const RequestRow& row : kRequestTable)
    text += "  :: event = " + event_macro(row.event) + "\n";
  text += "  fi\n}\n\n#define CALMS(event) (false";
  for (const RequestRow& row : kRequestTable) {
    if (row.calms) text += " || (event) == " + event_macro(row.event);
  }
  text += ")\n\n// The modes in which a condition for a fault is judged, bit m for mode m.\n";
  text += "inline any_condition(modes) {\n  if\n";
  std::vector<std::pair<ModeSet, std::string>> conditions;
  for (const FaultRow& row : kFaultTable) {
    const auto same = [&](const auto& condition) { return condition.first == row.modes; };
    const auto found = std::find_if(conditions.begin(), conditions.end(), same);
    if (found == conditions.end()) conditions.emplace_back(row.modes, row.name);
  }
  for (const auto& [modes, name] : conditions) {
    text += "  :: modes = " + std::to_string(modes) + "  // as " + name + "\n";
  }
  text += "  fi\n}\n#define JUDGED_IN(mode, modes) (((modes) >> (mode)) & 1)\n";
  return text;
}

TEST(ModeTableTest, TheModelOfTheModeMachineHasTheTablesOfTheCode) {
  const std::string expected = mode_table_promela();
  if (std::getenv("SANDRUNNER_RENEW") != nullptr)
    std::ofstream(SANDRUNNER_ROOT "/tests/models/mode_table.pml") << expected;
  std::ostringstream found;
  found << std::ifstream(SANDRUNNER_ROOT "/tests/models/mode_table.pml").rdbuf();
  EXPECT_EQ(found.str(), expected)
      << "tests/models/mode_table.pml is not made from these tables. Renew it with\n"
         "  SANDRUNNER_RENEW=1 build/release/bin/core_test --gtest_filter='ModeTableTest.*'\n"
         "and check the models again with\n"
         "  ctest --preset release -R '^Model'";
}

TEST(ModeTableTest, EveryEventHasANameInTheModel) {
  std::set<std::string> names;
  for (int e = 0; e < kNumEvents; ++e) {
    const std::string name = event_macro(static_cast<Event>(e));
    EXPECT_NE(name, "UNNAMED") << "event " << e;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
}

}  // namespace
}  // namespace sandrunner
