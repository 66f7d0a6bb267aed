// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_runs.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "rt/core/faults.h"
#include "rt/core/warnings.h"
#include "tests/drivers/robot/example.h"
#include "tools/hil/fault_script.h"

namespace sandrunner::hil {
namespace {

TEST(FaultRunsTest, EachCanBeReadAndNamesAFaultThatThereIs) {
  for (const FaultRun& run : fault_runs()) {
    if (*run.fault != '\0') {
      EXPECT_NO_THROW(read_fault(run.fault, example_hardware(run.hardware), example_robot()))
          << run.name;
    }
    if (*run.bit == '\0') continue;
    const bool known = std::any_of(kFaultTable.begin(), kFaultTable.end(), [&](const FaultRow& r) {
      return std::string(r.name) == run.bit;
    });
    const bool warns =
        std::any_of(kWarningTable.begin(), kWarningTable.end(),
                    [&](const WarningRow& row) { return std::string(row.name) == run.bit; });
    EXPECT_TRUE(known || warns) << run.name;
  }
}

TEST(FaultRunsTest, StandInTheReadmeAsTheyAreInTheCode) {
  std::ostringstream text;
  text << std::ifstream(SANDRUNNER_DRIVERS_README).rdbuf();
  const std::string table = fault_run_markdown();
  EXPECT_NE(text.str().find(table), std::string::npos) << "drivers/README.md should have:\n"
                                                       << table;
}

}  // namespace
}  // namespace sandrunner::hil
