// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/dds_io.h"

#include <fmt/format.h>

#include <random>

#include "rt/base/clock_ns.h"
#include "rt/operator/mode_requests.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/ros_time.h"

namespace sandrunner::ctl {
namespace {

constexpr int kModeDepth = 32;
constexpr dds_duration_t kRequestLifespan = DDS_MSECS(500);  // less than is waited for an answer

}  // namespace

std::uint32_t readers_of(dds_entity_t writer) {
  dds_publication_matched_status_t status;
  return dds_get_publication_matched_status(writer, &status) == DDS_RETCODE_OK
             ? status.current_count
             : 0;
}

std::uint32_t writers_of(dds_entity_t reader) {
  dds_subscription_matched_status_t status;
  return dds_get_subscription_matched_status(reader, &status) == DDS_RETCODE_OK
             ? status.current_count
             : 0;
}

std::string place(const DdsConfig& config) {
  return fmt::format("in domain {} on {}", config.domain, config.interface);
}

CommandWriter::CommandWriter(const DdsParticipant& participant, const DdsConfig& config)
    : stamped_(config.stamped_cmd_vel),
      writer_(participant.writer(
          "rt/cmd_vel",
          stamped_ ? geometry_msgs_msg_dds__TwistStamped__desc : geometry_msgs_msg_dds__Twist__desc,
          1)) {}

void CommandWriter::send(const VelocityCommand& command) {
  geometry_msgs_msg_dds__Twist_ twist{};
  twist.linear.x = command.vx_mps;
  twist.linear.y = command.vy_mps;
  twist.angular.z = command.wz_radps;
  // A write that fails is like a message that is lost on the way: the next one follows.
  if (!stamped_) {
    dds_write(writer_, &twist);
    return;
  }
  char frame[] = "base_link";
  geometry_msgs_msg_dds__TwistStamped_ stamped{};
  stamped.header.stamp = ros_time(clock_ns(CLOCK_REALTIME));
  stamped.header.frame_id = frame;
  stamped.twist = twist;
  dds_write(writer_, &stamped);
}

ModeClient::ModeClient(const DdsParticipant& participant)
    : replies_(
          participant.reader("sandrunner/mode_reply", sandrunner_ModeReply_desc, kModeDepth, true)),
      requests_(participant.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc,
                                   kModeDepth, false, kRequestLifespan)),
      calming_(
          participant.writer("sandrunner/mode_request", sandrunner_ModeRequest_desc, kModeDepth)) {}

void ModeClient::ask(std::string_view request) {
  std::random_device random;
  id_ = std::uint64_t{random()} << 32 | random();
  sandrunner_ModeRequest message{};
  message.id = id_;
  request.copy(message.request, sizeof message.request - 1);
  check_dds(dds_write(calms(request) ? calming_ : requests_, &message), "sandrunner/mode_request");
}

std::optional<sandrunner_ModeReply> ModeClient::reply() {
  std::optional<sandrunner_ModeReply> found;
  take(replies_, [&](const void* message, const dds_sample_info_t&) {
    const auto& reply = *static_cast<const sandrunner_ModeReply*>(message);
    if (reply.id == id_) found = reply;
  });
  return found;
}

}  // namespace sandrunner::ctl
