// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/telemetry/dds/ros.h"

namespace sandrunner {

/// A time in ROS 2's form; `stamp_ns` since 1970, not negative.
inline builtin_interfaces_msg_dds__Time_ ros_time(std::int64_t stamp_ns) noexcept {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return {static_cast<std::int32_t>(stamp_ns / kSecond_ns),
          static_cast<std::uint32_t>(stamp_ns % kSecond_ns)};
}

}  // namespace sandrunner
