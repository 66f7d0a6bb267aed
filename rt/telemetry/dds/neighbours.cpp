// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/neighbours.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "rt/base/errors.h"
#include "rt/telemetry/dds/ros.h"

namespace sandrunner {
namespace {

constexpr int kMost = 1000;  // endpoints; a large ROS 2 system has some hundreds

bool same(const dds_guid_t& a, const dds_guid_t& b) {
  return std::memcmp(a.v, b.v, sizeof a.v) == 0;
}

// `use` is given each of those that are there now.
template <typename Sample, typename Use>
void for_each(dds_entity_t reader, const Use& use) {
  std::vector<void*> samples(kMost);
  std::vector<dds_sample_info_t> infos(kMost);
  const int n = dds_read_mask(reader, samples.data(), infos.data(), kMost, kMost,
                              DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
  for (int i = 0; i < n; ++i) {
    if (infos[i].valid_data) use(*static_cast<const Sample*>(samples[i]));
  }
  if (n > 0) dds_return_loan(reader, samples.data(), n);
}

void add_once(std::vector<std::string>& texts, const std::string& text) {
  if (std::ranges::find(texts, text) == texts.end()) texts.push_back(text);
}

std::string property(const dds_qos_t* qos, const char* name) {
  char* value = nullptr;
  if (!dds_qget_prop(qos, name, &value)) return "?";
  std::string text = value;
  dds_free(value);
  return one_line(text);
}

}  // namespace

NeighbourWatch::NeighbourWatch(const DdsParticipant& participant, bool stamped_cmd_vel)
    : cmd_vel_type_((stamped_cmd_vel ? geometry_msgs_msg_dds__TwistStamped__desc
                                     : geometry_msgs_msg_dds__Twist__desc)
                        .m_typename),
      publications_(
          check_dds(dds_create_reader(participant.entity(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                      nullptr, nullptr),
                    "publications")),
      participants_(
          check_dds(dds_create_reader(participant.entity(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT,
                                      nullptr, nullptr),
                    "participants")) {
  check_dds(dds_get_guid(participant.entity(), &own_), "participant");
}

NeighbourWatch::~NeighbourWatch() {
  dds_delete(publications_);
  dds_delete(participants_);
}

Neighbours NeighbourWatch::look() const {
  Neighbours found;
  for_each<dds_builtintopic_endpoint_t>(
      publications_, [&](const dds_builtintopic_endpoint_t& writer) {
        if (same(writer.participant_key, own_)) return;
        const std::string_view topic = writer.topic_name;
        if (topic == "sandrunner/mode_reply") {
          found.robots.push_back(place_of(writer.participant_key));
        } else if (topic == "rt/cmd_vel" && cmd_vel_type_ != writer.type_name) {
          add_once(found.other_commands, one_line(writer.type_name));
        }
      });
  return found;
}

std::string NeighbourWatch::place_of(const dds_guid_t& participant) const {
  std::string place = "?";
  for_each<dds_builtintopic_participant_t>(
      participants_, [&](const dds_builtintopic_participant_t& p) {
        if (!same(p.key, participant)) return;
        place = fmt::format("host {}, process {}", property(p.qos, "__Hostname"),
                            property(p.qos, "__Pid"));
      });
  return place;
}

std::string joined(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace sandrunner
