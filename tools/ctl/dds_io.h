// SPDX-License-Identifier: BSD-3-Clause
// The operator's end of the topics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rt/core/messages.h"
#include "rt/dds/participant.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner::ctl {

/// How many readers a writer has found, and how many writers a reader has found.
std::uint32_t readers_of(dds_entity_t writer);
std::uint32_t writers_of(dds_entity_t reader);

/// "in domain 42 on lo".
std::string place(const DdsConfig& config);

/// Writes velocity commands to rt/cmd_vel.
class CommandWriter {
 public:
  /// Throws InputError.
  CommandWriter(const DdsParticipant& participant, const DdsConfig& config);

  bool has_robot() const { return readers_of(writer_) > 0; }
  void send(const VelocityCommand& command);

 private:
  bool stamped_;
  dds_entity_t writer_;
};

/// Sends mode requests and receives the answers, one request at a time. Where the network is gone,
/// a stop or damp is sent again until it arrives; what sets the robot in motion is not after half a
/// second: an operator who has read "no answer" must not see it move later.
class ModeClient {
 public:
  /// Throws InputError.
  explicit ModeClient(const DdsParticipant& participant);

  /// Whether there is a robot that can receive a request and answer it.
  bool has_robot() const {
    return readers_of(requests_) > 0 && readers_of(calming_) > 0 && writers_of(replies_) > 0;
  }
  /// How many robots would answer.
  std::uint32_t robots() const { return writers_of(replies_); }
  /// Sends the request with this name.
  void ask(std::string_view request);
  /// The answer to the latest request, once.
  std::optional<sandrunner_ModeReply> reply();

 private:
  dds_entity_t replies_, requests_, calming_;
  std::uint64_t id_ = 0;
};

}  // namespace sandrunner::ctl
