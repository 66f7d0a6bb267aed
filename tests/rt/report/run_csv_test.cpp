// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "tests/rt/report/made_up_trot.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

TEST(RunCsvTest, EveryRowHasAValueForEveryColumn) {
  const RunRecord record = trot(1.0, flat, kSinkage_m);
  const TemporaryFolder folder;
  write_csv(record, folder.path("run.csv"));
  EXPECT_EQ(folder.number_of_files(), 1u) << "no part of a file is left";
  std::ifstream file(folder.path("run.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const std::vector<std::string> columns = csv_columns(record.scene);
  std::string header;
  for (const std::string& column : columns) header += (header.empty() ? "" : ",") + column;
  EXPECT_EQ(line, header);
  // Time, mode, command 3, pose 7, speed 3, joints 36, 12 a leg, estimate and truth 8 each.
  EXPECT_EQ(columns.size(), 2U + 3U + 7U + 3U + 36U + 4U * 12U + 16U);
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
  EXPECT_EQ(rows, record.samples.size());
}

}  // namespace
}  // namespace sandrunner
