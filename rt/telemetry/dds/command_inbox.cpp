// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/command_inbox.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "rt/base/errors.h"
#include "rt/core/mode_machine.h"
#include "rt/telemetry/dds/ros.h"
#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner {
namespace {

constexpr int kRequestDepth = 32;
// Enough for all that publishers send before the thread gets to it: if only the newest were kept, a
// publisher that sends right after the holder of the command would silence it and take over.
constexpr int kVelocityDepth = 100;
// The controller answers within a tick; if it has not answered after this time, it is not running.
constexpr auto kAnswerTime = std::chrono::milliseconds(20);
constexpr auto kLookEvery = std::chrono::microseconds(250);
constexpr const char* kNoAnswer = "the controller does not answer";

std::int64_t steady_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Twist twist_from(const geometry_msgs_msg_dds__Twist_& t) {
  return {.linear_mps = {t.linear.x, t.linear.y, t.linear.z},
          .angular_radps = {t.angular.x, t.angular.y, t.angular.z}};
}

template <std::size_t kSize>
void copy_text(char (&to)[kSize], std::string_view from) {
  const std::size_t size = std::min(from.size(), kSize - 1);
  std::memcpy(to, from.data(), size);
  to[size] = '\0';
}

}  // namespace

CommandInbox::CommandInbox(const DdsParticipant& participant, const DdsConfig& config,
                           std::string robot, bool can_walk, DdsOperator& op)
    : operator_(op),
      robot_(std::move(robot)),
      stamped_(config.stamped_cmd_vel),
      can_walk_(can_walk),
      gate_(static_cast<std::int64_t>(config.stale_s * 1e9)),
      cmd_vel_(participant.reader(
          "rt/cmd_vel",
          stamped_ ? geometry_msgs_msg_dds__TwistStamped__desc : geometry_msgs_msg_dds__Twist__desc,
          kVelocityDepth, false)),
      requests_(participant.reader("sandrunner/mode_request", sandrunner_ModeRequest_desc,
                                   kRequestDepth, true)),
      replies_(
          participant.writer("sandrunner/mode_reply", sandrunner_ModeReply_desc, kRequestDepth)),
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

CommandCounts CommandInbox::counts() const noexcept {
  const auto velocities = [&](CommandVerdict verdict) {
    return velocities_[static_cast<std::size_t>(verdict)].load(std::memory_order_relaxed);
  };
  return {.accepted = velocities(CommandVerdict::kAccepted),
          .not_finite = velocities(CommandVerdict::kNotFinite),
          .absurd = velocities(CommandVerdict::kAbsurd),
          .other_publisher = velocities(CommandVerdict::kOtherPublisher),
          .requests_accepted = answers_[1].load(std::memory_order_relaxed),
          .requests_refused = answers_[0].load(std::memory_order_relaxed)};
}

void CommandInbox::run() {
  while (!end_) {
    dds_attach_t triggered[3];
    dds_waitset_wait(waitset_, triggered, 3, DDS_INFINITY);
    take_requests();  // first, because a stop may be among them
    take_velocity();
  }
}

void CommandInbox::take_velocity() {
  take(cmd_vel_, [this](const void* message, const dds_sample_info_t& info) {
    const Twist twist = twist_from(
        stamped_ ? static_cast<const geometry_msgs_msg_dds__TwistStamped_*>(message)->twist
                 : *static_cast<const geometry_msgs_msg_dds__Twist_*>(message));
    const CommandVerdict verdict = gate_.judge(twist, info.publication_handle, steady_ns());
    if (verdict == CommandVerdict::kAccepted) {
      holder_ = participant_of(cmd_vel_, info.publication_handle);
      asked_.velocity = {twist.linear_mps[0], twist.linear_mps[1], twist.angular_radps[2]};
      ++asked_.velocity_number;
      operator_.ask(asked_);
    }
    ++velocities_[static_cast<std::size_t>(verdict)];
  });
}

void CommandInbox::take_requests() {
  take(requests_, [this](const void* message, const dds_sample_info_t& info) {
    const auto& request = *static_cast<const sandrunner_ModeRequest*>(message);
    const RequestOutcome outcome =
        answer(request.request, participant_of(requests_, info.publication_handle));
    sandrunner_ModeReply reply{};
    reply.id = request.id;
    reply.accepted = outcome.accepted;
    copy_text(reply.mode, mode_name(operator_.mode()));
    copy_text(reply.robot, robot_);
    copy_text(reply.reason, outcome.accepted ? "" : outcome.text);
    dds_write(replies_, &reply);
  });
  take(texts_, [this](const void* message, const dds_sample_info_t& info) {
    const auto& text = *static_cast<const std_msgs_msg_dds__String_*>(message);
    answer(text.data, participant_of(texts_, info.publication_handle));
  });
  services_.answer(
      [this](std::string_view request, const dds_guid_t& asker) { return answer(request, asker); });
}

RequestOutcome CommandInbox::answer(std::string_view request, const dds_guid_t& asker) {
  const std::string refusal = is_request(request)
                                  ? follow(request, asker)
                                  : fmt::format("unknown, expected {}", kRequestNames);
  ++answers_[refusal.empty() ? 1 : 0];
  RequestOutcome outcome{refusal.empty(), refusal};
  if (outcome.accepted) outcome.text = fmt::format("mode {}", mode_name(operator_.mode()));
  const std::lock_guard lock(last_request_mutex_);
  last_request_ = fmt::format("{}: {}: {}", one_line(std::string(request.substr(0, 15))),
                              outcome.accepted ? "accepted" : "refused", outcome.text);
  return outcome;
}

std::string CommandInbox::last_request() const {
  const std::lock_guard lock(last_request_mutex_);
  return last_request_;
}

std::string CommandInbox::follow(std::string_view request, const dds_guid_t& asker) {
  // A stop or damp waits for a controller that does not answer; until the controller has taken it,
  // nothing but a damp replaces it.
  const bool waiting = calming_number_ > operator_.considered();
  if (waiting && request != "damp") return kNoAnswer;
  const RequestDecision decision = decide(request, operator_.mode(), can_walk_);
  if (decision.refusal) return decision.refusal;
  if (!decision.calms && gate_.held(steady_ns()) &&
      std::memcmp(asker.v, holder_.v, sizeof asker.v) != 0) {
    return "another operator drives the robot";
  }
  if (!decision.calms) {
    const std::vector<std::string> others = neighbours_.look().robots;
    if (!others.empty()) {
      return fmt::format("another robot would obey as well: {}", joined(others));
    }
  }
  if (decision.calms) {
    asked_.velocity = {};
    ++asked_.velocity_number;
  }
  if (decision.request != ModeRequest::kNone) {
    asked_.request = decision.request;
    ++asked_.request_number;
    if (decision.calms) calming_number_ = asked_.request_number;
  }
  operator_.ask(asked_);
  const auto deadline = std::chrono::steady_clock::now() + kAnswerTime;
  while (operator_.considered() != asked_.request_number) {
    if (std::chrono::steady_clock::now() > deadline) {
      // An operator who was refused must not see the robot move later; a stop or damp still holds.
      if (!decision.calms) {
        asked_.request = ModeRequest::kNone;
        ++asked_.request_number;
        operator_.ask(asked_);
      }
      return kNoAnswer;
    }
    std::this_thread::sleep_for(kLookEvery);
  }
  const char* const failed = failure(decision.request, operator_.mode());
  return failed ? failed : "";
}

}  // namespace sandrunner
