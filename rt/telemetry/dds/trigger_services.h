// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "rt/dds/participant.h"
#include "rt/operator/operator_desk.h"

namespace sandrunner {

/// The mode requests as ROS 2 services of the type std_srvs/Trigger: /sandrunner/stand and so on.
/// DDS has no services; each RMW makes them of topics in its own way. This is that of
/// rmw_cyclonedds: client and number of the call stand before the message. (rmw_fastrtps has them
/// in fields of RTPS that Cyclone DDS cannot set.)
class TriggerServices {
 public:
  /// Throws InputError.
  explicit TriggerServices(const DdsParticipant& participant);
  ~TriggerServices();
  TriggerServices(const TriggerServices&) = delete;
  TriggerServices& operator=(const TriggerServices&) = delete;

  /// Readers of the calls, to wait for.
  std::vector<dds_entity_t> readers() const;
  /// Takes and answers the calls that have arrived; `follow` is given the request and the
  /// participant that asks.
  void answer(
      const std::function<RequestOutcome(std::string_view request, const dds_guid_t&)>& follow);

 private:
  struct Service {
    std::string_view request;
    dds_entity_t calls, replies;
  };
  std::vector<Service> services_;
};

/// The participant of a writer that `reader` knows; zero if it is gone.
dds_guid_t participant_of(dds_entity_t reader, dds_instance_handle_t writer);

}  // namespace sandrunner
