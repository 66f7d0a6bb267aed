// SPDX-License-Identifier: BSD-3-Clause
// What a network of others sees and how it answers, as a TOML file.
#pragma once

#include <string>

#include "policy/perceptron_file.h"
#include "rt/core/robot_description.h"

namespace sandrunner {

/// The settings of a description that ships ("himloco_go2") or of a file (README.md has the keys),
/// for a robot. Weights, golden example, name and torque limit are left out. Throws InputError.
PerceptronFile read_description(const std::string& name_or_path, const RobotDescription& robot);

}  // namespace sandrunner
