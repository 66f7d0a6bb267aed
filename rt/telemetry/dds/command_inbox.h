// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <thread>

#include "rt/telemetry/dds/command_gate.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/dds_operator.h"
#include "rt/telemetry/dds/mode_requests.h"
#include "rt/telemetry/dds/participant.h"

namespace sandrunner {

/// What became of the commands since the start.
struct CommandCounts {
  std::uint64_t accepted = 0;                                     ///< velocity commands
  std::uint64_t not_finite = 0, absurd = 0, other_publisher = 0;  ///< refused ones
  std::uint64_t requests_accepted = 0, requests_refused = 0;
};

/// Reads rt/cmd_vel and sandrunner/mode_request in a thread of its own, at ordinary priority, and
/// passes on what it accepts. Every mode request is answered on sandrunner/mode_reply. While
/// somebody holds the velocity command, requests are accepted from that participant alone, but for
/// stop and damp, which anybody may ask for.
class CommandInbox {
 public:
  /// `participant` and `op` must outlive the inbox. `can_walk`: there is a policy. Throws
  /// InputError.
  CommandInbox(const DdsParticipant& participant, const DdsConfig& config, bool can_walk,
               DdsOperator& op);
  ~CommandInbox();
  CommandInbox(const CommandInbox&) = delete;
  CommandInbox& operator=(const CommandInbox&) = delete;

  /// From any thread.
  CommandCounts counts() const noexcept;

 private:
  void run();
  void take_velocity();
  void take_requests();
  void answer(std::uint64_t id, std::string_view request, dds_instance_handle_t writer);
  // Why not; null: done.
  const char* follow(std::string_view request, dds_instance_handle_t writer);

  DdsOperator& operator_;
  const bool stamped_, can_walk_;
  CommandGate gate_;
  dds_guid_t holder_{};  // participant of the velocity that was accepted last
  OperatorRequests asked_;
  std::uint64_t calming_number_ = 0;  // of the latest stop or damp
  dds_entity_t cmd_vel_, requests_, replies_, wake_, waitset_;
  std::array<std::atomic<std::uint64_t>, 4> velocities_{};  // by CommandVerdict
  std::array<std::atomic<std::uint64_t>, 2> answers_{};     // refused, accepted
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace sandrunner
