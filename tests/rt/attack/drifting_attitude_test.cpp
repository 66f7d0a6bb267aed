// SPDX-License-Identifier: BSD-3-Clause
// An attitude that drifts away while gyroscope and accelerometer are true. The robot walks on or
// stops with a fault; it never ends on its back.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "attack_loop.h"

namespace sandrunner::attack {
namespace {

constexpr Vector3 kRoll{1.0, 0.0, 0.0}, kPitch{0.0, 1.0, 0.0};

/// Walks at 1 m/s with an attitude that drifts by `drift_deg` at `rate_radps` and stays there.
Outcome drifting(const World& world, const Snapshot& at, const Vector3& axis, double drift_deg,
                 double rate_radps) {
  AttackLoop loop(world, Drives::kGains, at);
  loop.command.velocity.vx_mps = 1.0;
  const double drift_rad = drift_deg * std::numbers::pi / 180.0;
  loop.robot.spoil = [&](SensorFrame& fresh, const SensorFrame&, std::uint64_t n) {
    const double since_s = static_cast<double>(n) * kControlPeriod_s;
    const double angle_rad =
        std::copysign(std::min(rate_radps * since_s, std::fabs(drift_rad)), drift_rad);
    fresh.imu.orientation_wxyz = turned(fresh.imu.orientation_wxyz, axis, angle_rad);
  };
  return watch(loop, std::fabs(drift_rad) / rate_radps + 8.0);
}

/// Runs of one robot, ground, axis and rate, by how they ended.
struct DriftTally {
  int runs = 0, walked_on = 0, stopped = 0, fell = 0, on_its_back = 0;
  std::map<std::string, int> faults;
  double least_back_deg = 0.0, most_back_deg = 0.0;   ///< drifts that ended on the back
  double latest_s = 0.0, largest_at_fault_deg = 0.0;  ///< of the runs that stopped
  double largest_walked_deg = 0.0, torque_nm = 0.0;

  void add(double drift_deg, const Outcome& seen) {
    ++runs;
    torque_nm = std::max(torque_nm, seen.torque_nm);
    if (seen.fault != Fault::kNone) ++faults[fault_name(seen.fault)];
    if (seen.fell()) ++fell;
    if (seen.on_its_back()) {
      if (on_its_back++ == 0) least_back_deg = drift_deg;
      most_back_deg = drift_deg;
    } else if (seen.fault == Fault::kNone) {
      ++walked_on;
      largest_walked_deg = std::max(largest_walked_deg, std::fabs(drift_deg));
    } else {
      ++stopped;
      latest_s = std::max(latest_s, seen.after_s);
      largest_at_fault_deg = std::max(largest_at_fault_deg, degrees(seen.tilt_rad));
    }
  }
  void print(const std::string& name) const {
    std::printf("| %s | %d | %d (to %.0f) | %d (by %.1f s, at up to %.0f) | %d | ", name.c_str(),
                runs, walked_on, largest_walked_deg, stopped, latest_s, largest_at_fault_deg, fell);
    if (on_its_back > 0) {
      std::printf("**%d** (%.0f to %.0f) |", on_its_back, least_back_deg, most_back_deg);
    } else {
      std::printf("0 |");
    }
    for (const auto& [fault, count] : faults) std::printf(" %s %d", fault.c_str(), count);
    std::printf(" | %.0f N m |\n", torque_nm);
    std::fflush(stdout);
  }
};

TEST(DriftingAttitudeTest, NeverPutsAWalkingRobotOnItsBack) {
  const World world("raibo", "rigid");
  const Snapshot at = walking(world, Drives::kGains, {.vx_mps = 1.0});
  const Outcome control = drifting(world, at, kRoll, 0.0, 0.1);
  EXPECT_EQ(control.fault, Fault::kNone);
  EXPECT_LT(degrees(control.largest_tilt_rad), 15.0);
  for (const double drift_deg : {20.0, 29.0}) {
    const Outcome seen = drifting(world, at, kRoll, drift_deg, 0.1);
    EXPECT_FALSE(seen.fell()) << drift_deg << " degrees of roll: tilted by "
                              << degrees(seen.largest_tilt_rad) << ", " << fault_name(seen.fault)
                              << " after " << seen.after_s << " s";
  }
}

TEST(DriftingAttitudeTest, CampaignOverAnglesRatesGroundsAndRobots) {
  std::printf(
      "| robot, ground, axis, rate | runs | walks on (largest drift, degrees) | fault, not on "
      "its back (latest, largest true tilt) | tilted past 60 | on its back (drifts) | faults "
      "| torque |\n|---|---|---|---|---|---|---|---|\n");
  int on_its_back = 0;
  for (const std::string robot : {"raibo", "go2"}) {
    for (const std::string terrain : {"rigid", "dry-sand"}) {
      if (!is_selected(robot + ", " + terrain)) continue;
      const World world(robot, terrain);
      const Snapshot at = walking(world, Drives::kGains, {.vx_mps = 1.0});
      for (const double rate_radps : {0.1, 0.02, 0.05, 0.2, 0.4}) {
        const double step_deg = rate_radps == 0.1 ? 1.0 : 5.0;
        for (const Vector3& axis : {kRoll, kPitch}) {
          DriftTally tally;
          for (double drift_deg = 5.0; drift_deg <= 45.0; drift_deg += step_deg) {
            tally.add(drift_deg, drifting(world, at, axis, drift_deg, rate_radps));
          }
          char name[80];
          std::snprintf(name, sizeof name, "%s, %s, %s, %.2f rad/s", robot.c_str(), terrain.c_str(),
                        axis[0] > 0.5 ? "roll" : "pitch", rate_radps);
          tally.print(name);
          on_its_back += tally.on_its_back;
        }
      }
      DriftTally controls;
      for (int n = 0; n < 4; ++n) controls.add(0.0, drifting(world, at, kRoll, 0.0, 0.1));
      controls.print(robot + ", " + terrain + ", control without drift");
      EXPECT_EQ(controls.walked_on, controls.runs);
    }
  }
  EXPECT_EQ(on_its_back, 0);
}

}  // namespace
}  // namespace sandrunner::attack
