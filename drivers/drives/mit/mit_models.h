// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "drivers/drives/mit/mit.h"

namespace sandrunner {

/// A motor as its maker sells it. The limits are those that it is delivered with; where they were
/// changed in the drive, the changed ones count. So does the variant that a drive really answers
/// in: firmwares of one motor differ, a frame of the other one is MitStatus::kWrongLength.
struct MitModel {
  std::string_view name;
  MitVariant variant;
  MitLimits limits;
};

/// CubeMars: AK series manual 1.0.8, "MIT mode", and, for AK80 versions, the table of
/// github.com/dfki-ric-underactuated-lab/mini-cheetah-tmotor-python-can. The firmware's version
/// decides, not the motor's name alone. Damiao: constants of github.com/enactic/openarm_can.
/// Boards with Katz' own firmware have no row: their limits are settings in flash.
std::span<const MitModel> mit_models() noexcept;

/// The model of this name, nullptr if there is none.
const MitModel* find_mit_model(std::string_view name) noexcept;

}  // namespace sandrunner
