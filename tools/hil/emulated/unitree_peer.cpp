// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/unitree_peer.h"

#include <fmt/format.h>

#include "drivers/unitree/motion_switcher.h"
#include "drivers/unitree/robot_link.h"
#include "drivers/unitree/unitree_api.h"
#include "rt/base/errors.h"

namespace sandrunner::hil {
namespace {

constexpr std::int32_t kDone = 0, kNotImplemented = 3203;

DdsNetwork network_of(const UnitreeConfig& config) {
  DdsNetwork network;
  network.domain = config.domain;
  network.interface = config.interface;
  return network;
}

/// The type of commands under the name of that of states.
const dds_topic_descriptor_t& other_type() {
  static const dds_topic_descriptor_t type = [] {
    dds_topic_descriptor_t t = unitree_go_msg_dds__LowCmd__desc;
    t.m_typename = unitree_go_msg_dds__LowState__desc.m_typename;
    return t;
  }();
  return type;
}

/// Of commands, but not of those of this participant.
dds_entity_t command_reader(const DdsParticipant& participant) {
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 16);
  dds_qset_ignorelocal(qos, DDS_IGNORELOCAL_PARTICIPANT);
  const dds_entity_t topic =
      check_dds(dds_create_topic(participant.entity(), &unitree_go_msg_dds__LowCmd__desc,
                                 unitree::kCommandTopic, nullptr, nullptr),
                unitree::kCommandTopic);
  const dds_entity_t reader = dds_create_reader(participant.entity(), topic, qos, nullptr);
  dds_delete_qos(qos);
  return check_dds(reader, unitree::kCommandTopic);
}

}  // namespace

UnitreePeer::UnitreePeer(const UnitreeConfig& config, bool wrong_type)
    : participant_(network_of(config)),
      states_(participant_.writer(
          unitree::kStateTopic, wrong_type ? other_type() : unitree_go_msg_dds__LowState__desc, 1)),
      commands_(command_reader(participant_)),
      foreign_(participant_.writer(unitree::kCommandTopic, unitree_go_msg_dds__LowCmd__desc, 1)),
      requests_(participant_.reader(unitree::kSwitcherRequests, unitree_api_msg_dds__Request__desc,
                                    8, true)),
      responses_(participant_.writer(unitree::kSwitcherResponses,
                                     unitree_api_msg_dds__Response__desc, 8)) {}

void UnitreePeer::publish(const unitree::LowState& state) { dds_write(states_, &state); }

void UnitreePeer::take_commands(const std::function<void(const unitree::LowCmd&)>& use) {
  take(commands_, [&](const void* data, const dds_sample_info_t& info) {
    if (info.publication_handle != last_writer_) ++writers_;
    last_writer_ = info.publication_handle;
    use(*static_cast<const unitree::LowCmd*>(data));
  });
}

void UnitreePeer::send_foreign(const unitree::LowCmd& command) { dds_write(foreign_, &command); }

void UnitreePeer::serve() {
  take(requests_, [&](const void* data, const dds_sample_info_t&) {
    const auto& request = *static_cast<const unitree_api_msg_dds__Request_*>(data);
    if (!answers) return;
    unitree_api_msg_dds__Response_ response{};
    response.header.identity = request.header.identity;
    response.header.status.code = kDone;
    std::string answer;
    switch (static_cast<unitree::SwitcherRequest>(request.header.identity.api_id)) {
      case unitree::SwitcherRequest::kCheckMode:
        answer = fmt::format(R"({{"form":"0","name":"{}"}})", mode);
        if (mode.empty() && returns > 0 && !released_.empty()) {
          --returns;
          mode = released_;
        }
        break;
      case unitree::SwitcherRequest::kReleaseMode:
        ++releases;
        released_ = mode;
        mode.clear();
        break;
      default:
        response.header.status.code = kNotImplemented;
    }
    response.data = answer.data();
    dds_write(responses_, &response);
  });
}

}  // namespace sandrunner::hil
