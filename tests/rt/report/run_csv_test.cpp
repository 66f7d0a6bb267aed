// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/joint_names.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

/// A robot that stands up for a second and walks for another, without an estimate.
RunRecord made_up_run() {
  RunRecord record;
  for (std::size_t j = 0; j < kNumJoints; ++j) record.scene.robot.joint_names[j] = kJointNames[j];
  for (std::size_t l = 0; l < kNumLegs; ++l) record.scene.robot.leg_names[l] = kLegNames[l];
  for (int i = 0; i < 2 * kPolicyHz; ++i) {
    RunRow row;
    row.t_s = static_cast<double>(i) / kPolicyHz;
    const bool walks = i >= kPolicyHz;
    row.mode = static_cast<std::uint32_t>(walks ? Mode::kWalk : Mode::kStandUp);
    if (walks) row.given = {1.5f, 0.0f, 0.2f};
    row.position_m = {0.0, 0.0, 0.46};
    row.orientation_wxyz = {1.0f, 0.0f, 0.0f, 0.0f};
    row.estimate.fill(std::numeric_limits<float>::quiet_NaN());
    record.rows.push_back(row);
  }
  return record;
}

TEST(RunCsvTest, EveryRowHasAValueForEveryColumn) {
  const RunRecord record = made_up_run();
  const TemporaryFolder folder;
  write_csv(record, folder.path("run.csv"));
  EXPECT_EQ(folder.number_of_files(), 1u) << "no part of a file is left";
  std::ifstream file(folder.path("run.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const std::vector<std::string> columns = csv_columns(record.scene.robot);
  std::string header;
  for (const std::string& column : columns) header += (header.empty() ? "" : ",") + column;
  EXPECT_EQ(line, header);
  std::size_t numbers = 0;
  for (const RowField& field : kRowFields) {
    EXPECT_EQ(columns_of(field.columns, record.scene.robot).size(), field.count) << field.name;
    numbers += field.count;
  }
  EXPECT_EQ(columns.size(), numbers);
  std::vector<std::string> sorted = columns;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
  std::size_t rows = 0;
  while (std::getline(file, line)) {
    EXPECT_EQ(static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1,
              columns.size());
    if (rows == 0) {
      EXPECT_EQ(line.find("0,stand_up,0,0,0,0,0,0.46,1,0,0,0,"), 0U) << line;
      EXPECT_NE(line.find(",nan,nan,"), std::string::npos) << line;
    } else if (rows == 150) {
      EXPECT_EQ(line.find("1.5,walk,1.5,0,0.2,"), 0U) << line;
    }
    ++rows;
  }
  EXPECT_EQ(rows, record.rows.size());
}

TEST(RunCsvTest, ColumnsHaveTheNamesThatUsersKnow) {
  const std::vector<std::string> columns = csv_columns(made_up_run().scene.robot);
  for (const char* name : {"t_s",
                           "mode",
                           "command_vx_mps",
                           "command_wz_radps",
                           "base_x_m",
                           "orientation_w",
                           "vx_mps",
                           "vy_mps",
                           "yaw_rate_radps",
                           "LF_HAA_position_rad",
                           "RH_KFE_velocity_radps",
                           "LH_HFE_torque_nm",
                           "LF_hip_x_m",
                           "RF_knee_y_m",
                           "RH_foot_z_m",
                           "LH_penetration_m",
                           "RF_ground_height_m",
                           "LF_contact",
                           "estimate_body_height_m",
                           "estimate_velocity_x_mps",
                           "estimate_RH_foot_height_m",
                           "truth_velocity_z_mps",
                           "truth_LF_foot_height_m"}) {
    EXPECT_EQ(std::ranges::count(columns, name), 1) << name;
  }
}

TEST(RunCsvTest, AnUnwritablePathIsNamed) {
  const TemporaryFolder folder;
  const std::string path = folder.path("no such folder/file");
  const std::string error = error_of([&] { write_csv({}, path); });
  EXPECT_TRUE(error.starts_with(path + ": cannot be written (")) << error;
}

}  // namespace
}  // namespace sandrunner
