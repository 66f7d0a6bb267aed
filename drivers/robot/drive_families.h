// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "drivers/drives/mit/mit_drive.h"
#include "drivers/drives/moteus/moteus_drive.h"

namespace sandrunner {

/// A drive of one of the families. Call the overloads of drive_family.h with std::visit.
using AnyDrive = std::variant<MitDrive, MoteusDrive>;

}  // namespace sandrunner
