// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <thread>

#include "rt/dds/participant.h"
#include "rt/operator/operator_desk.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/neighbours.h"
#include "rt/telemetry/dds/trigger_services.h"

namespace sandrunner {

/// Reads rt/cmd_vel and mode requests in a thread of its own, at ordinary priority, and passes on
/// what it accepts. Requests come on sandrunner/mode_request and are answered on
/// sandrunner/mode_reply, as calls of ROS 2's services, or as a std_msgs/String on
/// rt/sandrunner/request, which is not answered; the desk decides about them all. While another
/// robot would obey as well, stop and damp are all that is accepted. A message that was lost is
/// sent again, and what it asks for is refused if its sender has asked for a stop or damp within
/// the last second. Of a flood of requests from one sender, most are ignored without an answer, but
/// never a stop or damp. So velocities and other operators are still served.
class CommandInbox {
 public:
  /// `participant` and `desk` must outlive the inbox. `robot`: who answers. Throws InputError.
  CommandInbox(const DdsParticipant& participant, const DdsConfig& config, std::string robot,
               OperatorDesk& desk);
  ~CommandInbox();
  CommandInbox(const CommandInbox&) = delete;
  CommandInbox& operator=(const CommandInbox&) = delete;

 private:
  struct Calmed {
    dds_time_t stamp = 0;  // of the sender's clock, which may be set back at any time
    std::chrono::steady_clock::time_point arrival;
  };

  void run();
  // These return whether there may be more to take.
  bool take_velocity();
  bool take_requests();
  bool is_due(std::string_view request, dds_instance_handle_t writer);
  RequestOutcome answer(std::string_view request, const dds_guid_t& asker);
  RequestOutcome answer(std::string_view request, dds_entity_t reader,
                        const dds_sample_info_t& info);
  std::string objection() const;

  OperatorDesk& desk_;
  const std::string robot_;
  const bool stamped_;
  dds_entity_t cmd_vel_, requests_, replies_, texts_, wake_, waitset_;
  TriggerServices services_;
  NeighbourWatch neighbours_;
  std::map<dds_instance_handle_t, int> followed_;  // requests of each writer, since `asked_since_`
  std::chrono::steady_clock::time_point asked_since_{};
  std::string calming_;                  // the latest request that was followed, if stop or damp
  std::map<OperatorId, Calmed> calmed_;  // the latest stop or damp of each
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace sandrunner
