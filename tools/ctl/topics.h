// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "dds/dds.h"
#include "rt/telemetry/dds/dds_config.h"

namespace sandrunner::ctl {

/// A topic of the robot, and how its messages become text.
struct Topic {
  const char* name;
  const dds_topic_descriptor_t* type;
  int depth;      ///< messages to keep until they are read
  bool reliable;  ///< false: from any writer
  bool latched;
  std::string (*text)(const void* message);  ///< a message of `type` as a line, without line end
};

/// The topic with this name. Throws an InputError that lists all topics.
Topic find_topic(const std::string& name, const DdsConfig& config);

/// "rt/joint_states, rt/imu/data, ...".
std::string topic_names();

}  // namespace sandrunner::ctl
