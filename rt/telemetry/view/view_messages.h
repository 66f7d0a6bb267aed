// SPDX-License-Identifier: BSD-3-Clause
// What a page may say. Everything else is refused.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "rt/core/messages.h"
#include "rt/telemetry/view/view_control.h"

namespace sandrunner {

inline constexpr double kSlowestPace = 0.05, kFastestPace = 4.0;
inline constexpr int kMostSteps_ticks = 4000;

/// {"say":"hello","key":"..."}: the first message of a page.
struct PageHello {
  std::string key;  ///< empty: it only looks
};
/// {"say":"drive","vx":1.0,"vy":0,"wz":0}: m/s, m/s, rad/s.
struct PageDrive {
  VelocityCommand velocity;
};
/// {"say":"request","name":"stand"}
struct PageRequest {
  std::string name;
};
/// {"say":"pace","rate":0.5}: times the robot's own speed.
struct PagePace {
  double rate = 1.0;
};
/// {"say":"pause","on":true}
struct PagePause {
  bool on = false;
};
/// {"say":"step","ticks":40}: goes so far and pauses again.
struct PageStep {
  int ticks = 1;
};
/// {"say":"push","direction":1.57}: rad from world x.
struct PagePush {
  double direction_rad = 0.0;
};
/// {"say":"set_on_legs"}
struct PageSetOnLegs {};
/// {"say":"terrain","preset":"wet-sand","set":{"friction":0.6}}
struct PageTerrain {
  WantedGround ground;
};
/// What it said instead of any of these.
struct PageNonsense {
  std::string why;
};

using PageMessage = std::variant<PageNonsense, PageHello, PageDrive, PageRequest, PagePace,
                                 PagePause, PageStep, PagePush, PageSetOnLegs, PageTerrain>;

/// Strict: one JSON object with exactly the keys of its kind, of their types and within their
/// ranges.
PageMessage parse_page_message(std::string_view text);

}  // namespace sandrunner
