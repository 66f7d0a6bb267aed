// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "rt/telemetry/dds/command_gate.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/dds_operator.h"
#include "rt/telemetry/dds/mode_requests.h"
#include "rt/telemetry/dds/neighbours.h"
#include "rt/telemetry/dds/participant.h"
#include "rt/telemetry/dds/trigger_services.h"

namespace sandrunner {

/// What became of the commands since the start.
struct CommandCounts {
  std::uint64_t accepted = 0;                                     ///< velocity commands
  std::uint64_t not_finite = 0, absurd = 0, other_publisher = 0;  ///< refused ones
  std::uint64_t requests_accepted = 0, requests_refused = 0;
};

/// Reads rt/cmd_vel and mode requests in a thread of its own, at ordinary priority, and passes on
/// what it accepts. Requests come on sandrunner/mode_request and are answered on
/// sandrunner/mode_reply, as calls of ROS 2's services, or as a std_msgs/String on
/// rt/sandrunner/request, which is not answered; one and the same code follows them all. While
/// somebody holds the velocity command, requests are accepted from that participant alone, but for
/// stop and damp, which anybody may ask for. While another robot would obey as well, stop and damp
/// are all that is accepted.
class CommandInbox {
 public:
  /// `participant` and `op` must outlive the inbox. `robot`: who answers. `can_walk`: there is a
  /// policy. Throws InputError.
  CommandInbox(const DdsParticipant& participant, const DdsConfig& config, std::string robot,
               bool can_walk, DdsOperator& op);
  ~CommandInbox();
  CommandInbox(const CommandInbox&) = delete;
  CommandInbox& operator=(const CommandInbox&) = delete;

  /// From any thread.
  CommandCounts counts() const noexcept;
  /// The latest mode request and what became of it; empty: none yet. From any thread.
  std::string last_request() const;

 private:
  void run();
  void take_velocity();
  void take_requests();
  RequestOutcome answer(std::string_view request, const dds_guid_t& asker);
  // Why not; empty: done.
  std::string follow(std::string_view request, const dds_guid_t& asker);

  DdsOperator& operator_;
  const std::string robot_;
  const bool stamped_, can_walk_;
  CommandGate gate_;
  dds_guid_t holder_{};  // participant of the velocity that was accepted last
  OperatorRequests asked_;
  std::uint64_t calming_number_ = 0;  // of the latest stop or damp
  dds_entity_t cmd_vel_, requests_, replies_, texts_, wake_, waitset_;
  TriggerServices services_;
  NeighbourWatch neighbours_;
  std::array<std::atomic<std::uint64_t>, 4> velocities_{};  // by CommandVerdict
  std::array<std::atomic<std::uint64_t>, 2> answers_{};     // refused, accepted
  mutable std::mutex last_request_mutex_;
  std::string last_request_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace sandrunner
