// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/trigger_services.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstring>
#include <thread>

#include "rt/core/mode_machine.h"
#include "rt/telemetry/dds/ros.h"

namespace sandrunner {
namespace {

constexpr int kServiceDepth = 10;  // rmw_qos_profile_services_default
// A client may have found us before we have found its reader of replies; rmw_cyclonedds waits
// likewise.
constexpr auto kFindReader = std::chrono::milliseconds(100);
constexpr auto kLookEvery = std::chrono::milliseconds(1);

// Whether a reader of this participant reads what `writer` writes.
bool is_read_by(dds_entity_t writer, const dds_guid_t& participant) {
  std::array<dds_instance_handle_t, 64> readers{};
  const int n = dds_get_matched_subscriptions(writer, readers.data(), readers.size());
  bool found = false;
  for (int i = 0; i < n && i < static_cast<int>(readers.size()) && !found; ++i) {
    dds_builtintopic_endpoint_t* const reader =
        dds_get_matched_subscription_data(writer, readers[static_cast<std::size_t>(i)]);
    if (!reader) continue;
    found = std::memcmp(reader->participant_key.v, participant.v, sizeof participant.v) == 0;
    dds_builtintopic_free_endpoint(reader);
  }
  return found;
}

}  // namespace

dds_guid_t participant_of(dds_entity_t reader, dds_instance_handle_t writer) {
  dds_guid_t key{};
  if (dds_builtintopic_endpoint_t* const data = dds_get_matched_publication_data(reader, writer)) {
    key = data->participant_key;
    dds_builtintopic_free_endpoint(data);
  }
  return key;
}

TriggerServices::TriggerServices(const DdsParticipant& participant) {
  for (const RequestRow& row : kRequestTable) {
    const std::string_view request = row.name;
    services_.push_back(
        {.request = request,
         .calls = participant.reader(fmt::format("rq/sandrunner/{}Request", request).c_str(),
                                     std_srvs_srv_dds__Trigger_Request__desc, kServiceDepth, true),
         .replies = participant.writer(fmt::format("rr/sandrunner/{}Reply", request).c_str(),
                                       std_srvs_srv_dds__Trigger_Response__desc, kServiceDepth)});
  }
}

TriggerServices::~TriggerServices() {
  for (const Service& service : services_) {
    dds_delete(service.calls);
    dds_delete(service.replies);
  }
}

std::vector<dds_entity_t> TriggerServices::readers() const {
  std::vector<dds_entity_t> readers;
  for (const Service& service : services_) readers.push_back(service.calls);
  return readers;
}

void TriggerServices::answer(
    const std::function<RequestOutcome(std::string_view request, const dds_guid_t&)>& follow) {
  struct Reply {
    dds_entity_t writer;
    dds_guid_t asker;
    std_srvs_srv_dds__Trigger_Response_ to;
    RequestOutcome outcome;
  };
  std::vector<Reply> replies;
  for (const Service& service : services_) {
    take(
        service.calls,
        [&](const void* message, const dds_sample_info_t& info) {
          const auto& call = *static_cast<const std_srvs_srv_dds__Trigger_Request_*>(message);
          const dds_guid_t asker = participant_of(service.calls, info.publication_handle);
          replies.push_back({.writer = service.replies,
                             .asker = asker,
                             .to = {.client = call.client,
                                    .number = call.number,
                                    .success = false,
                                    .message = nullptr},
                             .outcome = follow(service.request, asker)});
        },
        kServiceDepth);
  }
  // All were followed before any is waited for: a client that is gone holds up no stop.
  const auto deadline = std::chrono::steady_clock::now() + kFindReader;
  for (Reply& reply : replies) {
    while (!is_read_by(reply.writer, reply.asker) && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(kLookEvery);
    }
    reply.to.success = reply.outcome.accepted;
    reply.to.message = reply.outcome.text.data();
    dds_write(reply.writer, &reply.to);
  }
}

}  // namespace sandrunner
