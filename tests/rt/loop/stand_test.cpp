// SPDX-License-Identifier: BSD-3-Clause
// Stand, for long, on every ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "watch.h"

namespace sandrunner {
namespace {

class StandTest : public testing::Test {
 protected:
  /// Stands up and stands on this ground for up to 30 s. The largest tilt, rad.
  double largest_tilt_rad(const std::string& terrain) {
    const ProcessConfig config = config_of(terrain, {}, &policy_.spec());
    DisturbedLoop loop(config, policy_, Drives::kGains);
    loop.run(0.2);
    loop.ask(ModeRequest::kArm);
    loop.run(0.2);
    loop.ask(ModeRequest::kStand);
    double largest_rad = 0.0;
    int tenths = 0;
    do {
      loop.run(0.1);
      largest_rad = std::max(largest_rad, tilt_rad(loop.truth()));
      end_ = loop.record.output.mode;
    } while (++tenths < 300 && (end_ == Mode::kStandUp || end_ == Mode::kStand));
    loop.run(2.0);
    EXPECT_EQ(loop.record.output.faults, 0u) << terrain;
    std::printf("  %-15s %s after %4.1f s, tilt at most %4.1f degrees\n", terrain.c_str(),
                mode_name(end_), 0.1 * tenths, degrees(largest_rad));
    return largest_rad;
  }
  const Policy policy_ = load_shipped_policy();
  Mode end_ = Mode::kPassive;
};

TEST_F(StandTest, HoldsOnGroundThatHolds) {
  for (const char* const terrain :
       {"dry-sand", "wet-sand", "grass", "athletic-track", "vinyl", "rigid"}) {
    EXPECT_LT(largest_tilt_rad(terrain), 0.1) << terrain;
    EXPECT_EQ(end_, Mode::kStand) << terrain;
  }
}

TEST_F(StandTest, WhereTheGroundGivesWayTheRobotLiesDownBeforeItTopples) {
  for (const char* const terrain : {"memory-foam", "air-mattress"}) {
    EXPECT_LT(largest_tilt_rad(terrain), 0.5) << terrain;
    EXPECT_EQ(end_, Mode::kDamping) << terrain;
  }
}

}  // namespace
}  // namespace sandrunner
