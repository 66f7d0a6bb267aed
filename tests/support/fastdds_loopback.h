// SPDX-License-Identifier: BSD-3-Clause
// What peers on eProsima's Fast DDS need, whether it is Fast DDS 2 (Debian 12) or 3 (Debian 13).
#pragma once

#if __has_include(<fastdds/utils/IPLocator.hpp>)
#define SANDRUNNER_FASTDDS_3
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#endif

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>

namespace sandrunner {

#ifdef SANDRUNNER_FASTDDS_3
constexpr auto kReturnedOk = eprosima::fastdds::dds::RETCODE_OK;
using eprosima::fastdds::rtps::IPLocator;
using eprosima::fastdds::rtps::Locator_t;
#else
constexpr auto kReturnedOk = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
#endif

/// The types of this participant are matched by their names, as those of ROS 2 are: Fast DDS 3
/// would send what it knows of them.
inline void send_no_type_information(eprosima::fastdds::dds::DomainParticipantQos& qos) {
#ifdef SANDRUNNER_FASTDDS_3
  qos.properties().properties().emplace_back("fastdds.type_propagation", "disabled");
#else
  static_cast<void>(qos);  // Fast DDS 2: named_type()
#endif
}

/// A participant of eProsima's Fast DDS that sends and listens on the loopback interface alone,
/// without multicast, as our own participants of tests do.
inline eprosima::fastdds::dds::DomainParticipantQos fastdds_loopback_qos() {
  eprosima::fastdds::dds::DomainParticipantQos qos =
      eprosima::fastdds::dds::PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  Locator_t loopback;
  loopback.kind = LOCATOR_KIND_UDPv4;
  IPLocator::setIPv4(loopback, 127, 0, 0, 1);
  qos.wire_protocol().builtin.initialPeersList.push_back(loopback);
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(loopback);
  send_no_type_information(qos);
  return qos;
}

/// Of a type as ROS 2 sends it, under a name of its own and without type information.
template <typename PubSubType>
eprosima::fastdds::dds::TypeSupport named_type(const char* name) {
  eprosima::fastdds::dds::TypeSupport support(new PubSubType());
#ifdef SANDRUNNER_FASTDDS_3
  support->set_name(name);
#else
  support->setName(name);
  support->auto_fill_type_object(false);
  support->auto_fill_type_information(false);
#endif
  return support;
}

}  // namespace sandrunner
