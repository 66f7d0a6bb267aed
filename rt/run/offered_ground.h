// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "sim/ground/ground.h"

namespace sandrunner {

/// What pages may set of the ground: keys without "terrain.".
inline constexpr std::pair<const char*, double sim::GroundParameters::*> kOfferedGround[] = {
    {"sigma_flat_npm3", &sim::GroundParameters::sigma_flat_npm3},
    {"sigma_cone_npm3", &sim::GroundParameters::sigma_cone_npm3},
    {"stiffness_npm", &sim::GroundParameters::stiffness_npm},
    {"friction", &sim::GroundParameters::friction},
    {"drag", &sim::GroundParameters::drag},
    {"packing", &sim::GroundParameters::packing},
    {"strength_pa", &sim::GroundParameters::strength_pa},
    {"suction", &sim::GroundParameters::suction}};

}  // namespace sandrunner
