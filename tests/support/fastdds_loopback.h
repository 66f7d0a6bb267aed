// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <memory>

namespace sandrunner {

/// A participant of eProsima's Fast DDS that sends and listens on the loopback interface alone,
/// without multicast, as our own participants of tests do.
inline eprosima::fastdds::dds::DomainParticipantQos fastdds_loopback_qos() {
  eprosima::fastdds::dds::DomainParticipantQos qos =
      eprosima::fastdds::dds::PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  eprosima::fastrtps::rtps::Locator_t loopback;
  loopback.kind = LOCATOR_KIND_UDPv4;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(loopback, 127, 0, 0, 1);
  qos.wire_protocol().builtin.initialPeersList.push_back(loopback);
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(loopback);
  return qos;
}

}  // namespace sandrunner
