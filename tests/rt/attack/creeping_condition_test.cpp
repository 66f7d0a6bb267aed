// SPDX-License-Identifier: BSD-3-Clause
// A drive that becomes too hot and a battery that becomes low, in Walk: conditions that leave time.
// The robot stops and lies down as after a request to lie down, instead of dropping at full speed.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "attack_loop.h"

namespace sandrunner::attack {
namespace {

constexpr std::uint64_t kTooHot = 2, kBatteryLow = 4, kMotorMode = 1;  // UnitreeFault

/// Which drives report what.
struct Report {
  std::uint64_t code = 0, joints = 0;
  bool urgent = false;

  void add_to(SensorFrame& fresh) const {
    for (int j = 0; j < kNumJoints; ++j) {
      if ((joints >> j & 1) == 0) continue;
      (urgent ? fresh.joints.drive_fault : fresh.joints.drive_warning)[j] = code;
    }
  }
};
constexpr Report kHotDrive{kTooHot, 1u << 11}, kBattery{kBatteryLow, 0xfff},
    kOtherFault{kMotorMode, 1u << 11, true};

/// How the body met the ground: with its belly, or on thighs that no longer walk.
struct Landing {
  double walked_mps = 0.0;  ///< before
  double after_s = -1.0;    ///< below 0: it did not
  double speed_mps = 0.0, forward_mps = 0.0, down_mps = 0.0;
  double largest_tilt_rad = 0.0;
  Fault fault = Fault::kNone;
};

/// Walks on for `wait_s`, then has the report, or the request if there is none.
Landing landing(const World& world, const Snapshot& at, double wait_s, const Report* report,
                ModeRequest request = ModeRequest::kNone) {
  AttackLoop loop(world, Drives::kGains, at);
  loop.command.velocity.vx_mps = 2.5;
  loop.run(wait_s);
  Landing seen;
  seen.walked_mps = length(loop.truth().velocity_mps);
  if (report != nullptr) {
    loop.robot.spoil = [report](SensorFrame& fresh, auto&&...) { report->add_to(fresh); };
  } else {
    loop.ask(request);
  }
  for (std::uint64_t n = 1; n <= ticks_from_s(20.0); ++n) {
    const Vector3 before_mps = loop.truth().velocity_mps;
    loop.step();
    seen.largest_tilt_rad = std::max(seen.largest_tilt_rad, tilt_rad(loop.truth()));
    if (seen.fault == Fault::kNone) seen.fault = loop.fault();
    const bool on_legs = loop.truth().thigh_contact != 0 && loop.mode() != Mode::kWalk;
    const bool down = loop.truth().base_contact != 0 || on_legs;
    if (seen.after_s >= 0.0 || !down) continue;
    seen.after_s = static_cast<double>(n) * kControlPeriod_s;
    seen.speed_mps = length(before_mps);
    seen.forward_mps = std::hypot(before_mps[0], before_mps[1]);
    seen.down_mps = -before_mps[2];
    if (n + ticks_from_s(3.0) < ticks_from_s(20.0)) n = ticks_from_s(17.0);
  }
  return seen;
}

constexpr int kMoments = 8;

/// The fastest landing of eight moments of a stride.
Landing fastest(const World& world, const Snapshot& at, const Report* report,
                ModeRequest request = ModeRequest::kNone) {
  Landing worst;
  for (int n = 0; n < kMoments; ++n) {
    const Landing seen = landing(world, at, 0.05 * n, report, request);
    const double tilt_so_far_rad = std::max(worst.largest_tilt_rad, seen.largest_tilt_rad);
    if (worst.after_s < 0.0 || seen.speed_mps > worst.speed_mps) worst = seen;
    worst.largest_tilt_rad = tilt_so_far_rad;
  }
  return worst;
}

void print_landing(const std::string& name, const Landing& seen) {
  std::printf("| %s | %.2f | %.2f | **%.2f** | %.2f | %.2f | %.0f | %s |\n", name.c_str(),
              seen.walked_mps, seen.after_s, seen.speed_mps, seen.forward_mps, seen.down_mps,
              degrees(seen.largest_tilt_rad), fault_name(seen.fault));
  std::fflush(stdout);
}

TEST(CreepingConditionTest, AHotDriveAndALowBatteryLetARunningRobotStopFirst) {
  const World world("raibo", "rigid");
  const Snapshot at = walking(world, Drives::kGains, {.vx_mps = 2.5});
  const Landing control = landing(world, at, 0.0, nullptr, ModeRequest::kLie);
  EXPECT_GE(control.after_s, 0.0);
  EXPECT_LT(control.speed_mps, 0.6);
  for (const Report& report : {kHotDrive, kBattery}) {
    const Landing seen = landing(world, at, 0.0, &report);
    EXPECT_GE(seen.after_s, 0.0);
    EXPECT_LT(seen.speed_mps, 0.6);
  }
}

TEST(CreepingConditionTest, CampaignOverReportsGroundsAndRobots) {
  std::printf(
      "| fastest of 8 moments | walked m/s | down after s | at m/s | forward m/s | down m/s "
      "| "
      "largest tilt | fault |\n|---|---|---|---|---|---|---|---|\n");
  for (const std::string robot : {"raibo", "go2"}) {
    for (const std::string terrain : {"rigid", "dry-sand"}) {
      if (!is_selected(robot + ", " + terrain)) continue;
      const World world(robot, terrain);
      const Snapshot at = walking(world, Drives::kGains, {.vx_mps = 2.5});
      const std::string where = robot + ", " + terrain + ", ";
      const Landing control = fastest(world, at, nullptr, ModeRequest::kLie);
      print_landing(where + "control: lie", control);
      print_landing(where + "another drive fault", fastest(world, at, &kOtherFault));
      const Landing hot = fastest(world, at, &kHotDrive);
      print_landing(where + "a drive too hot", hot);
      const Landing battery = fastest(world, at, &kBattery);
      print_landing(where + "battery low", battery);
      EXPECT_LE(hot.speed_mps, control.speed_mps + 0.2) << where;
      EXPECT_LE(battery.speed_mps, control.speed_mps + 0.2) << where;
    }
  }
}

}  // namespace
}  // namespace sandrunner::attack
