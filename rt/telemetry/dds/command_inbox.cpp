// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/command_inbox.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "rt/base/guard_process.h"
#include "rt/core/mode_machine.h"
#include "rt/operator/mode_requests.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner {
namespace {

constexpr int kReplyDepth = 32;
// Of all senders together, and the most that one look takes: one that floods the topic must not
// push out the others' requests before the thread gets to them.
constexpr int kRequestDepth = 1024;
constexpr int kMostFollowed = 100;  // of one sender's requests in this time
constexpr auto kFloodTime = std::chrono::milliseconds(100);
// A message that was lost comes again sooner than that. What is stamped earlier and comes later is
// of a clock that was set back.
constexpr auto kLateTime = std::chrono::seconds(1);
constexpr std::size_t kMostCalmed = 64;
// Enough for all that publishers send before the thread gets to it: if only the newest were kept, a
// publisher that sends right after the holder of the command would silence it and take over.
constexpr int kVelocityDepth = 100;
Twist twist_from(const geometry_msgs_msg_dds__Twist_& t) {
  return {.linear_mps = {t.linear.x, t.linear.y, t.linear.z},
          .angular_radps = {t.angular.x, t.angular.y, t.angular.z}};
}

OperatorId operator_of(const dds_guid_t& participant) {
  OperatorId id;
  static_assert(sizeof id == sizeof participant.v);
  std::memcpy(id.data(), participant.v, sizeof id);
  return id;
}

}  // namespace

CommandInbox::CommandInbox(const DdsParticipant& participant, const DdsConfig& config,
                           std::string robot, OperatorDesk& desk)
    : desk_(desk),
      robot_(std::move(robot)),
      stamped_(config.stamped_cmd_vel),
      cmd_vel_(participant.reader(
          "rt/cmd_vel",
          stamped_ ? geometry_msgs_msg_dds__TwistStamped__desc : geometry_msgs_msg_dds__Twist__desc,
          kVelocityDepth, false)),
      requests_(participant.reader("sandrunner/mode_request", sandrunner_ModeRequest_desc,
                                   kRequestDepth, true)),
      replies_(participant.writer("sandrunner/mode_reply", sandrunner_ModeReply_desc, kReplyDepth)),
      texts_(participant.reader("rt/sandrunner/request", std_msgs_msg_dds__String__desc,
                                kRequestDepth, false)),
      wake_(check_dds(dds_create_guardcondition(participant.entity()), "guard condition")),
      waitset_(check_dds(dds_create_waitset(participant.entity()), "waitset")),
      services_(participant),
      neighbours_(participant, stamped_) {
  std::vector<dds_entity_t> readers = services_.readers();
  readers.insert(readers.end(), {cmd_vel_, requests_, texts_});
  for (const dds_entity_t reader : readers) {
    check_dds(dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS), "status mask");
    check_dds(dds_waitset_attach(waitset_, reader, reader), "waitset");
  }
  check_dds(dds_waitset_attach(waitset_, wake_, wake_), "waitset");
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "dds-commands");
}

CommandInbox::~CommandInbox() {
  end_ = true;
  dds_set_guardcondition(wake_, true);
  thread_.join();
  for (const dds_entity_t entity : {waitset_, wake_, cmd_vel_, requests_, replies_, texts_}) {
    dds_delete(entity);
  }
}

void CommandInbox::run() {
  bool more = false;  // what was left untaken does not trigger again
  while (!end_) {
    dds_attach_t triggered[3];
    if (!more) dds_waitset_wait(waitset_, triggered, 3, DDS_INFINITY);
    more = take_requests();  // first, because a stop may be among them
    more = take_velocity() || more;
  }
}

bool CommandInbox::take_velocity() {
  // One look at the network for all that has arrived.
  const OperatorDesk::Objection seen = [why_not = objection()] { return why_not; };
  const auto use = [&](const void* message, const dds_sample_info_t& info) {
    const Twist twist = twist_from(
        stamped_ ? static_cast<const geometry_msgs_msg_dds__TwistStamped_*>(message)->twist
                 : *static_cast<const geometry_msgs_msg_dds__Twist_*>(message));
    desk_.drive(twist, info.publication_handle,
                operator_of(participant_of(cmd_vel_, info.publication_handle)), seen);
  };
  return take(cmd_vel_, use, kVelocityDepth) == kVelocityDepth;
}

// Whether a request is to be followed, or is one too many.
bool CommandInbox::is_due(std::string_view request, dds_instance_handle_t writer) {
  const auto now = std::chrono::steady_clock::now();
  if (now - asked_since_ > kFloodTime) {
    followed_.clear();
    asked_since_ = now;
  }
  int& followed = followed_[writer];
  // The same stop again, or one after a damp, would change nothing.
  const bool calming = calms(request) && request != calming_ && calming_ != "damp";
  if (followed >= kMostFollowed && !calming) return false;
  ++followed;
  calming_ = calms(request) ? request : "";
  return true;
}

bool CommandInbox::take_requests() {
  const auto follow = [this](const void* message, const dds_sample_info_t& info) {
    const auto& request = *static_cast<const sandrunner_ModeRequest*>(message);
    if (!is_due(request.request, info.publication_handle)) return;
    const RequestOutcome outcome = answer(request.request, requests_, info);
    sandrunner_ModeReply reply{};
    reply.id = request.id;
    reply.accepted = outcome.accepted;
    write_text(mode_name(desk_.mode()), reply.mode);
    write_text(robot_, reply.robot);
    write_text(outcome.accepted ? "" : outcome.text, reply.reason);
    dds_write(replies_, &reply);
  };
  const auto follow_text = [this](const void* message, const dds_sample_info_t& info) {
    const auto& text = *static_cast<const std_msgs_msg_dds__String_*>(message);
    if (is_due(text.data, info.publication_handle)) answer(text.data, texts_, info);
  };
  bool more = take(requests_, follow, kRequestDepth) == kRequestDepth;
  more = take(texts_, follow_text, kRequestDepth) == kRequestDepth || more;
  services_.answer(
      [this](std::string_view request, const dds_guid_t& asker) { return answer(request, asker); });
  return more;
}

RequestOutcome CommandInbox::answer(std::string_view request, const dds_guid_t& asker) {
  calming_.clear();
  return desk_.request(request, operator_of(asker), [this] { return objection(); });
}

RequestOutcome CommandInbox::answer(std::string_view request, dds_entity_t reader,
                                    const dds_sample_info_t& info) {
  const OperatorId asker = operator_of(participant_of(reader, info.publication_handle));
  const auto now = std::chrono::steady_clock::now();
  const auto calmed = calmed_.find(asker);
  const bool late = calmed != calmed_.end() && info.source_timestamp < calmed->second.stamp &&
                    now - calmed->second.arrival < kLateTime;
  if (!late && calms(request)) {
    if (calmed_.size() >= kMostCalmed) calmed_.clear();
    calmed_[asker] = {info.source_timestamp, now};
  }
  return desk_.request(request, asker, [&] {
    return late ? "was asked for before the latest stop or damp, and came after it" : objection();
  });
}

std::string CommandInbox::objection() const {
  const std::vector<std::string> others = neighbours_.look().robots;
  return others.empty() ? std::string()
                        : fmt::format("another robot would obey as well: {}", joined(others));
}

}  // namespace sandrunner
