// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/drive_family.h"

#include <fmt/format.h>

namespace sandrunner {

std::string describe(const SetPoint& c) {
  return fmt::format("{:.4f} rad, {:.3f} rad/s, kp {:.2f}, kd {:.3f}, {:.3f} N m", c.position_rad,
                     c.velocity_radps, c.kp_nmprad, c.kd_nmsprad, c.torque_nm);
}

}  // namespace sandrunner
