// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/bus_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/drivers/robot/example.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

TEST(BusPlanTest, ThreeMitDrivesWithRepliesOfEightBytesFit800HzAndNot1000) {
  const std::vector<PlannedBus> at_800 = plan_buses(example_hardware("mit"));
  ASSERT_EQ(at_800.size(), 4u);
  EXPECT_EQ(at_800[0].drives, 3);
  EXPECT_NEAR(at_800[0].load.worst, 3 * 270e-6 * 800, 1e-12);
  EXPECT_FALSE(at_800[0].overloaded());

  const std::vector<PlannedBus> at_1000 =
      plan_buses(example_hardware("mit", {"hardware.rate_hz=1000"}));
  EXPECT_NEAR(at_1000[0].load.worst, 0.81, 1e-12);
  EXPECT_TRUE(at_1000[0].overloaded());
  EXPECT_EQ(at_1000[0].most_drives, 2);
  EXPECT_EQ(at_1000[0].most_rate_hz, 800.0);
}

TEST(BusPlanTest, MoteusAtOneKilohertzFits) {
  const std::vector<PlannedBus> plan = plan_buses(example_hardware("moteus"));
  EXPECT_LT(plan[0].load.worst, kMaxBusLoad);
  EXPECT_GT(plan[0].load.worst, 0.4);
}

TEST(BusPlanTest, NothingOffTheShelfCarriesThreeTorqueDrivesAtFourKilohertz) {
  for (const char* name : {"mit", "moteus"}) {
    const std::vector<PlannedBus> plan =
        plan_buses(example_hardware(name, {"hardware.mode=torque", "hardware.rate_hz=4000"}));
    EXPECT_TRUE(plan[0].overloaded()) << name;
    EXPECT_LE(plan[0].most_drives, 1) << name;
  }
}

TEST(BusPlanTest, TableSaysWhatWouldFit) {
  const HardwareConfig config = example_hardware("mit", {"hardware.rate_hz=1000"});
  const std::string table = plan_table(config, plan_buses(config));
  EXPECT_THAT(table, testing::HasSubstr("can3"));
  EXPECT_THAT(table, testing::HasSubstr("OVERLOADED"));
  EXPECT_THAT(table, testing::HasSubstr("800 Hz"));
}

TEST(BusPlanTest, AnOverloadedBusIsRefusedUnlessTheKernelEmulatesIt) {
  const HardwareConfig config = example_hardware("mit", {"hardware.rate_hz=1000"});
  EXPECT_NO_THROW(require_capacity(config, [](const std::string&) { return true; }));
  const auto is_can0 = [](const std::string& bus) { return bus == "can0"; };
  EXPECT_EQ(error_of([&] { require_capacity(config, is_can0); }),
            "hardware.bus can1: 3 drives at 1000 Hz load it by 81 % in the worst case, at most "
            "80 % leave room for a lost frame; 2 drives fit, or 800 Hz (sandrunner check --plan)");
}

TEST(BusPlanTest, AnInterfaceThatIsNotThereIsNotEmulated) {
  EXPECT_FALSE(is_virtual("nosuch0"));
  EXPECT_TRUE(is_virtual("lo"));
}

}  // namespace
}  // namespace sandrunner
