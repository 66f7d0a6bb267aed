// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "rt/core/messages.h"

namespace sandrunner {

inline constexpr std::array<const char*, kNumJoints> kJointNames = {
    "LF_HAA", "LF_HFE", "LF_KFE", "RF_HAA", "RF_HFE", "RF_KFE",
    "LH_HAA", "LH_HFE", "LH_KFE", "RH_HAA", "RH_HFE", "RH_KFE"};

}  // namespace sandrunner
