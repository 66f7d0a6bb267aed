// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/robot_link.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"

namespace sandrunner::unitree {
namespace {

constexpr std::uint32_t kTypePolicy = DDS_TYPE_CONSISTENCY_ENFORCEMENT_QOS_POLICY_ID;

// In a thread of Cyclone DDS.
void wake(dds_entity_t, void* event) { eventfd_write(*static_cast<const int*>(event), 1); }

}  // namespace

RobotLink::RobotLink(const UnitreeConfig& config, int receive_priority)
    : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)), states_(config.tick_hz) {
  if (event_ < 0) throw InputError("hardware.unitree: no file descriptor is left (ulimit -n)");
  DdsNetwork network;
  network.domain = config.domain;
  network.interface = config.interface;
  network.receive_priority = receive_priority;
  participant_ = std::make_unique<DdsParticipant>(network);
  state_reader_ = participant_->reader(kStateTopic, unitree_go_msg_dds__LowState__desc, 32, false);
  switcher_ = std::make_unique<MotionSwitcher>(*participant_);
  // Not through the participant: this reader is not to hear this process's own commands.
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 8);
  dds_qset_ignorelocal(qos, DDS_IGNORELOCAL_PARTICIPANT);
  const dds_entity_t topic =
      check_dds(dds_create_topic(participant_->entity(), &unitree_go_msg_dds__LowCmd__desc,
                                 kCommandTopic, nullptr, nullptr),
                kCommandTopic);
  command_reader_ = dds_create_reader(participant_->entity(), topic, qos, nullptr);
  dds_delete_qos(qos);
  check_dds(command_reader_, kCommandTopic);
  dds_listener_t* const listener = dds_create_listener(&event_);
  dds_lset_data_available(listener, wake);
  dds_set_listener(state_reader_, listener);
  dds_set_listener(command_reader_, listener);
  dds_delete_listener(listener);
}

RobotLink::~RobotLink() {
  participant_.reset();  // with the listener, which uses the descriptor
  close(event_);
}

bool RobotLink::wait(std::int64_t until_ns) {
  const std::int64_t left_ns = std::max<std::int64_t>(until_ns - clock_ns(CLOCK_MONOTONIC), 0);
  const timespec timeout{.tv_sec = left_ns / 1'000'000'000, .tv_nsec = left_ns % 1'000'000'000};
  pollfd file{.fd = event_, .events = POLLIN, .revents = 0};
  if (ppoll(&file, 1, &timeout, nullptr) <= 0) return false;
  eventfd_t ignored;
  eventfd_read(event_, &ignored);
  return poll();
}

bool RobotLink::poll() {
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
  const long long states = take(state_reader_, [&](const void* data, const dds_sample_info_t&) {
    states_.take(*static_cast<const LowState*>(data), now_ns);
  });
  take(command_reader_, [&](const void*, const dds_sample_info_t&) { ++foreign_; });
  return states > 0;
}

bool RobotLink::wrong_state_type() const {
  dds_requested_incompatible_qos_status_t status{};
  return dds_get_requested_incompatible_qos_status(state_reader_, &status) == DDS_RETCODE_OK &&
         status.total_count > 0 && status.last_policy_id == kTypePolicy;
}

bool RobotLink::wrong_command_type() const {
  dds_offered_incompatible_qos_status_t status{};
  return command_writer_ > 0 &&
         dds_get_offered_incompatible_qos_status(command_writer_, &status) == DDS_RETCODE_OK &&
         status.total_count > 0 && status.last_policy_id == kTypePolicy;
}

void RobotLink::open_commands() {
  command_writer_ = participant_->writer(kCommandTopic, unitree_go_msg_dds__LowCmd__desc, 1);
}

bool RobotLink::commands_are_read() const {
  dds_publication_matched_status_t status{};
  return dds_get_publication_matched_status(command_writer_, &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

void RobotLink::send(const LowCmd& command) noexcept {
  ++(dds_write(command_writer_, &command) == DDS_RETCODE_OK ? sent_ : not_sent_);
}

}  // namespace sandrunner::unitree
