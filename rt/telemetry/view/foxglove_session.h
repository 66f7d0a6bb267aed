// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "rt/telemetry/view/live_topics.h"
#include "rt/telemetry/view/view_session.h"

namespace sandrunner {

/// Foxglove or Lichtblick at the other end, by Foxglove's WebSocket protocol
/// (github.com/foxglove/ws-protocol). It gets the topics that it subscribes to, of those that a
/// recording has, and can do nothing else: no publishing, no parameters, no services.
class FoxgloveSession final : public ViewSession {
 public:
  /// `topics` must outlive the session. `run`: another one in each process.
  FoxgloveSession(LiveTopics& topics, const std::string& run);
  ~FoxgloveSession() override;
  FoxgloveSession(const FoxgloveSession&) = delete;
  FoxgloveSession& operator=(const FoxgloveSession&) = delete;

  std::optional<Goodbye> take(std::string_view text) override;
  Claim claim() const override { return Claim::kLooks; }

 private:
  Outgoing next_data() override;
  using Id = std::uint32_t;  // of a subscription, chosen by the client
  // What is wrong with it; empty: nothing.
  std::string subscribe(const nlohmann::json& wish);
  std::string unsubscribe(const nlohmann::json& id);
  std::shared_ptr<const LiveTopics::Message> next_message();

  LiveTopics& topics_;
  std::array<std::optional<Id>, kNumRunTopics> ids_;  // by RunTopic
  RunTopics subscribed_;
  RunTopics owed_;  // topics with one message, which is not sent yet
  std::uint64_t place_, said_ns_ = 0;
  std::shared_ptr<const LiveTopics::Message> held_;  // until its time is sent
};

}  // namespace sandrunner
