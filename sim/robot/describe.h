// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

/// One robot as the simulator and the gate know it, in Markdown, for a person to compare with the
/// real one before anything moves: masses and what was put together into a body, joints with axes,
/// stops and limits, feet, what of the URDF is not used.
std::string describe(const Robot& robot);

}  // namespace sandrunner::sim
