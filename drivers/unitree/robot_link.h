// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/unitree/messages.h"
#include "drivers/unitree/motion_switcher.h"
#include "drivers/unitree/state_watch.h"
#include "drivers/unitree/unitree_config.h"
#include "rt/dds/participant.h"

namespace sandrunner::unitree {

inline constexpr const char* kCommandTopic = "rt/lowcmd";
inline constexpr const char* kStateTopic = "rt/lowstate";

/// This process at the robot's DDS domain: hears states and what other programs command, asks the
/// motion switcher. It sends no command to the robot before open_commands(). One thread.
class RobotLink {
 public:
  /// `receive_priority`: SCHED_FIFO of the thread that receives; 0: an ordinary one. Throws
  /// InputError.
  RobotLink(const UnitreeConfig& config, int receive_priority);
  ~RobotLink();
  RobotLink(const RobotLink&) = delete;
  RobotLink& operator=(const RobotLink&) = delete;

  /// Takes what arrives until `until_ns`, CLOCK_MONOTONIC; returns earlier if something did. True:
  /// a state did, be it a new one or not.
  bool wait(std::int64_t until_ns);
  /// Takes what has arrived. True: a state has.
  bool poll();

  StateWatch& states() noexcept { return states_; }
  MotionSwitcher& switcher() noexcept { return *switcher_; }
  /// Commands that other programs sent to this robot.
  std::uint64_t foreign_commands() const noexcept { return foreign_; }
  /// Another program publishes states, or reads commands, of another type under the name of ours.
  bool wrong_state_type() const;
  bool wrong_command_type() const;

  /// From now on commands can be sent. Throws InputError.
  void open_commands();
  /// Whether the robot reads them.
  bool commands_are_read() const;
  void send(const LowCmd& command) noexcept;
  std::uint64_t sent() const noexcept { return sent_; }
  std::uint64_t not_sent() const noexcept { return not_sent_; }

 private:
  int event_ = -1;  // eventfd: something has arrived
  std::unique_ptr<DdsParticipant> participant_;
  dds_entity_t state_reader_ = 0, command_reader_ = 0, command_writer_ = 0;
  std::unique_ptr<MotionSwitcher> switcher_;
  StateWatch states_;
  std::uint64_t foreign_ = 0, sent_ = 0, not_sent_ = 0;
};

}  // namespace sandrunner::unitree
