// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/fault_runs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rt/core/faults.h"
#include "rt/core/warnings.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/hil/bench_examples.h"

namespace sandrunner::hil {
namespace {

void expect_sound(std::span<const FaultRun> runs) {
  for (const FaultRun& run : runs) {
    const ProcessConfig config = bench_example(*run.hardware != '\0' ? run.hardware : "unitree");
    EXPECT_NO_THROW(read_faults(config, run.faults_of(config.robot.description))) << run.name;
    const auto is_named = [&](const auto& row) { return std::string(row.name) == run.bit; };
    EXPECT_TRUE(*run.bit == '\0' || std::ranges::any_of(kFaultTable, is_named) ||
                std::ranges::any_of(kWarningTable, is_named))
        << run.name;
    for (const std::string& joint : run.joints_of(config.robot.description)) {
      EXPECT_NE(std::ranges::find(config.robot.description.joint_names, joint),
                config.robot.description.joint_names.end())
          << run.name;
    }
  }
}

TEST(FaultRunsTest, EachCanBeReadAndNamesWhatThereIs) {
  expect_sound(can_fault_runs());
  expect_sound(unitree_fault_runs());
}

TEST(FaultRunsTest, StandInTheReadmesAsTheyAreInTheCode) {
  const std::pair<const char*, std::span<const FaultRun>> tables[] = {
      {SANDRUNNER_DRIVERS_README, can_fault_runs()},
      {SANDRUNNER_UNITREE_README, unitree_fault_runs()}};
  for (const auto& [readme, runs] : tables) {
    const std::string table = fault_run_markdown(runs);
    EXPECT_NE(read_file(readme).find(table), std::string::npos) << readme << " should have:\n"
                                                                << table;
  }
}

TEST(FaultRunsTest, AScriptHasSeveralFaultsAndTheFaultyJoint) {
  const RobotDescription robot = bench_example("unitree").robot.description;
  const FaultRun run{"", "", "start firmware-damps; 1 nan {}", "", kThatJoint, "", "", 1, 0.0};
  EXPECT_EQ(run.faults_of(robot),
            (std::vector<std::string>{"start firmware-damps", "1 nan FL_calf_joint"}));
  EXPECT_EQ(run.joints_of(robot), (std::set<std::string>{"FL_calf_joint"}));
}

}  // namespace
}  // namespace sandrunner::hil
