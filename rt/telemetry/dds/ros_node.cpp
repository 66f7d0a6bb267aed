// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/ros_node.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "rt/telemetry/dds/ros.h"

namespace sandrunner {

void announce_node(const DdsParticipant& participant, const std::string& name) {
  const auto gid_of = [](dds_entity_t entity) {
    dds_guid_t guid{};
    dds_get_guid(entity, &guid);
    rmw_dds_common_msg_dds__Gid_ gid;
    std::copy(std::begin(guid.v), std::end(guid.v), gid.data);
    return gid;
  };
  const auto gids = [&](const std::vector<dds_entity_t>& entities) {
    std::vector<rmw_dds_common_msg_dds__Gid_> all;
    for (const dds_entity_t entity : entities) all.push_back(gid_of(entity));
    return all;
  };
  std::vector<rmw_dds_common_msg_dds__Gid_> readers = gids(participant.readers()),
                                            writers = gids(participant.writers());
  const auto sequence = [](std::vector<rmw_dds_common_msg_dds__Gid_>& of) {
    const auto size = static_cast<std::uint32_t>(of.size());
    return dds_sequence_rmw_dds_common_msg_dds__Gid_{size, size, of.data(), false};
  };
  std::string space = "/", own_name = name;
  rmw_dds_common_msg_dds__NodeEntitiesInfo_ node{.node_namespace = space.data(),
                                                 .node_name = own_name.data(),
                                                 .reader_gid_seq = sequence(readers),
                                                 .writer_gid_seq = sequence(writers)};
  const rmw_dds_common_msg_dds__ParticipantEntitiesInfo_ info{gid_of(participant.entity()),
                                                              {1, 1, &node, false}};
  constexpr const char* kTopic = "ros_discovery_info";
  const dds_entity_t to =
      participant.writer(kTopic, rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc, 1, true);
  check_dds(dds_write(to, &info), kTopic);
}

}  // namespace sandrunner
