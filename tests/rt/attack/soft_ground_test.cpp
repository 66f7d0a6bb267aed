// SPDX-License-Identifier: BSD-3-Clause
// Stand for two minutes on grounds without layers or mud, without a push. It does not topple.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "attack_loop.h"

namespace sandrunner::attack {
namespace {

Outcome stand_on(const std::string& robot, const std::string& terrain, double duration_s) {
  const World world(robot, terrain);
  AttackLoop loop(world, Drives::kGains);
  loop.run(0.1);
  loop.ask(ModeRequest::kArm);
  loop.run(0.1);
  loop.ask(ModeRequest::kStand);
  return watch(loop, duration_s);
}

TEST(SoftGroundTest, StandDoesNotToppleThere) {
  EXPECT_FALSE(stand_on("raibo", "rigid", 12.0).fell()) << "control";
  for (const std::string terrain : {"memory-foam", "air-mattress"}) {
    const Outcome seen = stand_on("raibo", terrain, 12.0);
    EXPECT_FALSE(seen.fell()) << terrain << ": " << fault_name(seen.fault) << " after "
                              << seen.after_s << " s";
  }
}

TEST(SoftGroundTest, CampaignOverGroundsAndRobots) {
  for (const std::string robot : {"raibo", "go2"}) {
    for (const std::string terrain : {"memory-foam", "air-mattress", "rigid", "dry-sand",
                                      "wet-sand", "grass", "athletic-track", "vinyl"}) {
      if (!is_selected(robot + ", " + terrain)) continue;
      const Outcome seen = stand_on(robot, terrain, 124.0);
      std::printf("%s, %s: largest tilt %.0f degrees, %s\n", robot.c_str(), terrain.c_str(),
                  degrees(seen.largest_tilt_rad), fault_name(seen.fault));
      EXPECT_FALSE(seen.fell()) << robot << ", " << terrain;
    }
  }
}

}  // namespace
}  // namespace sandrunner::attack
