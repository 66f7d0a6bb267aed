// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rt/dds/participant.h"

namespace sandrunner {

/// Tells ROS 2 that all writers and readers of `participant` made so far belong to a node /`name`.
/// Throws InputError.
void announce_node(const DdsParticipant& participant, const std::string& name);

}  // namespace sandrunner
