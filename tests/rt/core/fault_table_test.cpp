// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "rt/core/faults.h"

namespace sandrunner {
namespace {

TEST(FaultTableTest, StandsInTheReadmeAsItIsInTheCode) {
  std::ostringstream text;
  text << std::ifstream(SANDRUNNER_CORE_README).rdbuf();
  const std::string readme = text.str();
  const std::string table = fault_table_markdown();
  EXPECT_NE(readme.find(table), std::string::npos) << "rt/core/README.md should have:\n" << table;
}

}  // namespace
}  // namespace sandrunner
