// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/gamepad.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <cmath>

#include "tools/ctl/key_driver.h"

namespace sandrunner::ctl {
namespace {

// The sticks of worn gamepads rest anywhere in this share of the way to full deflection.
constexpr double kDeadZone = 0.1;

}  // namespace

static_assert(Gamepad::kAxes == std::array<std::uint16_t, 3>{ABS_X, ABS_Y, ABS_RX});

void Gamepad::center() {
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i] = static_cast<int>((std::int64_t{ranges_[i].min} + ranges_[i].max) / 2);
  }
}

void Gamepad::event(std::uint16_t type, std::uint16_t code, std::int32_t value) {
  if (type == EV_KEY && code == BTN_TL) {
    if (value == 0) enabled_ = false;
    if (value == 1) enabled_ = true;  // 2: a held button repeats
  } else if (type == EV_ABS) {
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      if (code == kAxes[i]) values_[i] = value;
    }
  } else if (type == EV_SYN && code == SYN_DROPPED) {
    stop();  // events were lost, perhaps the release of the button
  }
}

double Gamepad::deflection(std::size_t axis) const {
  const AxisRange& r = ranges_[axis];
  const double half = 0.5 * (static_cast<double>(r.max) - r.min);
  if (!(half > 0.0)) return 0.0;
  const double way = std::clamp((values_[axis] - (r.min + half)) / half, -1.0, 1.0);
  const double dead = std::clamp(r.flat / half, kDeadZone, 0.5);
  const double beyond = std::max(std::abs(way) - dead, 0.0) / (1.0 - dead);
  return std::copysign(beyond, way);
}

bool Gamepad::silent(std::int64_t now_ns) const {
  const bool held = deflection(0) != 0.0 || deflection(1) != 0.0 || deflection(2) != 0.0;
  return enabled_ && held && now_ns - heard_ns_ > kSilence_ns;
}

std::optional<VelocityCommand> Gamepad::command(double scale, std::int64_t now_ns) const {
  if (!enabled_) return std::nullopt;
  if (silent(now_ns)) return VelocityCommand{};
  // Sticks are positive to the right and down, velocities to the left and forward. 0 - x instead of
  // -x: no negative zero.
  return VelocityCommand{.vx_mps = 0.0 - scale * kFullSpeed.vx_mps * deflection(1),
                         .vy_mps = 0.0 - scale * kFullSpeed.vy_mps * deflection(0),
                         .wz_radps = 0.0 - scale * kFullSpeed.wz_radps * deflection(2)};
}

}  // namespace sandrunner::ctl
