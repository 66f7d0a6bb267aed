// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rt/telemetry/view/view_messages.h"
#include "rt/telemetry/view/view_server.h"
#include "rt/telemetry/view/view_session.h"

namespace sandrunner {

/// A page of ours: it says hello first, then it is sent frames and, ten times a second, the state,
/// so that silence means something. If it has the key, its messages change the run.
class PageSession final : public ViewSession {
 public:
  /// `parts` must outlive the session. `key`, `run`: of this process. `page`: its number among the
  /// pages of the server.
  PageSession(const ViewServer::Parts& parts, std::string key, std::string run, std::uint64_t page);

  std::optional<Goodbye> take(std::string_view text) override;
  Claim claim() const override { return claim_; }

 private:
  Outgoing next_data() override;
  void greet(const PageHello& hello);
  // Each does what the message orders. Its answer is JSON for the page, empty if there is none.
  std::string follow(const PageMessage& message);
  std::string drive(const PageDrive& order);
  std::string request(const PageRequest& order);
  std::string touch(const PageMessage& message);
  OperatorId id() const;

  const ViewServer::Parts& parts_;
  const std::string key_, run_;
  const std::uint64_t page_;
  Claim claim_ = Claim::kNone;
  ViewFeed::Place in_feed_;
  std::chrono::steady_clock::time_point state_due_{};
};

}  // namespace sandrunner
