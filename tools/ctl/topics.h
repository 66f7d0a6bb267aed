// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "dds/dds.h"
#include "rt/telemetry/dds/dds_config.h"

namespace sandrunner::ctl {

/// One of our topics, and its messages as text.
struct Topic {
  const char* name;
  const dds_topic_descriptor_t* type;
  int depth;      ///< messages to keep until they are looked at
  bool reliable;  ///< false: from any writer
  bool latched;
  std::string (*text)(const void* message);  ///< of a message of `type`, one line without its end
};

/// The topic of this name. Throws InputError that names those that there are.
Topic find_topic(const std::string& name, const DdsConfig& config);

/// "rt/joint_states, rt/imu/data, ...".
std::string topic_names();

}  // namespace sandrunner::ctl
