// SPDX-License-Identifier: BSD-3-Clause
// What the messages of a page do to the run, without a socket.
#pragma once

#include <cstdint>
#include <string>

#include "rt/telemetry/view/view_messages.h"
#include "rt/telemetry/view/view_server.h"

namespace sandrunner {

/// {"say":"state",...}: what changes while a run goes on.
std::string view_state(const ViewServer::Parts& parts);
/// {"say":"refused","why":"..."}
std::string view_refusal(const std::string& why);

/// The orders of one page.
class ViewOrders {
 public:
  struct Outcome {
    std::string answer = {};  ///< JSON for the page; empty: none
    bool changed = false;     ///< view_state may be another
  };

  /// `parts` must outlive this object. `page`: its number among the pages of the server.
  ViewOrders(const ViewServer::Parts& parts, std::uint64_t page) : parts_(parts), page_(page) {}

  /// Does what the message orders, or answers why not. `has_key`: the page may change things.
  Outcome follow(const PageMessage& message, bool has_key);

 private:
  Outcome drive(const PageDrive& order);
  Outcome request(const PageRequest& order);
  Outcome touch(const PageMessage& message);
  OperatorId id() const;

  const ViewServer::Parts& parts_;
  const std::uint64_t page_;
};

}  // namespace sandrunner
