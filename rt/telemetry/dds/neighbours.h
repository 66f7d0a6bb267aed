// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "rt/dds/participant.h"

namespace sandrunner {

/// Who else is in the domain, as far as it concerns a robot.
struct Neighbours {
  /// Other robots that would obey the same requests: "host robot7, process 4711".
  std::vector<std::string> robots;
  /// Types under which others publish rt/cmd_vel and which the robot does not read.
  std::vector<std::string> other_commands;
};

/// Looks for them in what DDS discovers. Used by one thread.
class NeighbourWatch {
 public:
  /// `participant` must outlive the watch. `stamped_cmd_vel`: which type the robot reads. Throws
  /// InputError.
  NeighbourWatch(const DdsParticipant& participant, bool stamped_cmd_vel);
  ~NeighbourWatch();
  NeighbourWatch(const NeighbourWatch&) = delete;
  NeighbourWatch& operator=(const NeighbourWatch&) = delete;

  /// Those that are there now. One that was killed counts for another ten seconds.
  Neighbours look() const;

 private:
  std::string place_of(const dds_guid_t& participant) const;

  const std::string cmd_vel_type_;
  dds_guid_t own_{};
  const dds_entity_t publications_, participants_;
};

/// "a, b".
std::string joined(const std::vector<std::string>& texts);

}  // namespace sandrunner
