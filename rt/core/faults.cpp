// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/faults.h"

#include "rt/core/mode_machine.h"
#include "rt/core/warnings.h"

namespace sandrunner {
namespace {

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

}  // namespace

const char* fault_name(Fault fault) noexcept {
  if (fault == Fault::kNone) return "none";
  for (const FaultRow& row : kFaultTable) {
    if (row.fault == fault) return row.name;
  }
  return "unknown";
}

std::string fault_table_markdown() {
  std::string text =
      "| fault | what is wrong | from | in modes | within |\n|---|---|---|---|---|\n";
  for (const FaultRow& row : kFaultTable) {
    text += std::string("| `") + row.name + "` | " + row.meaning + " | " + row.sensor + " | " +
            modes_text(row.modes) + " | " + row.within + " |\n";
  }
  return text;
}

std::string warning_table_markdown() {
  std::string text = "| warning | first limit | second limit |\n|---|---|---|\n";
  for (const WarningRow& row : kWarningTable) {
    text += std::string("| `") + row.name + "` | " + row.meaning + " | " + row.second + " |\n";
  }
  return text;
}

}  // namespace sandrunner
