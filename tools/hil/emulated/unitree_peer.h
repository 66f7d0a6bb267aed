// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "drivers/unitree/messages.h"
#include "drivers/unitree/unitree_config.h"
#include "rt/dds/participant.h"

namespace sandrunner::hil {

/// The robot's end of Unitree's DDS topics: publishes states, takes commands, answers the motion
/// switcher. One thread.
class UnitreePeer {
 public:
  /// `wrong_type`: its states are of another type under the right name. Throws InputError.
  explicit UnitreePeer(const UnitreeConfig& config, bool wrong_type = false);

  void publish(const unitree::LowState& state);
  /// Gives `use` each command that has arrived.
  void take_commands(const std::function<void(const unitree::LowCmd&)>& use);
  /// Sends a command as another program would.
  void send_foreign(const unitree::LowCmd& command);
  /// Answers requests that have arrived.
  void serve();

  /// Writers of commands so far: programs that command the robot.
  int writers() const noexcept { return writers_; }

  std::string mode = "";  ///< which of the robot's own programs controls it; empty: none
  int returns = 0;        ///< so often it comes back after a release
  bool answers = true;    ///< the switcher does
  int releases = 0;       ///< that were asked for

 private:
  DdsParticipant participant_;
  // The robot's own programs have a writer of commands too, which is silent while they are off.
  dds_entity_t states_, commands_, foreign_, requests_, responses_;
  dds_instance_handle_t last_writer_ = 0;
  int writers_ = 0;
  std::string released_;  // mode that is to return at the next look
};

}  // namespace sandrunner::hil
