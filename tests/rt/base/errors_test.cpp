// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/errors.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

TEST(ErrorsTest, NoControlCharacterReachesATerminal) {
  EXPECT_EQ(one_line("a\nb\tc\x1b[2Jd\x7f"), "a b c [2Jd ");
  EXPECT_EQ(one_line("a\xc2\x9b"
                     "2J\xc2\x85"),
            "a  2J  ")
      << "those of UTF-8: CSI, next line";
  EXPECT_EQ(one_line("\xc2\xa0\xc3\xa9\xc2"), "\xc2\xa0\xc3\xa9\xc2") << "other characters stay";
}

TEST(ErrorsTest, ALongMessageLosesItsMiddle) {
  const std::string message = "begin" + std::string(5000, 'x') + "end";
  const std::string line = one_line(message);
  EXPECT_LT(line.size(), 1100u);
  EXPECT_TRUE(line.starts_with("begin") && line.ends_with("end"));
}

}  // namespace
}  // namespace sandrunner
