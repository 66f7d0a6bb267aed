// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "rt/operator/operator_desk.h"
#include "rt/telemetry/view/live_topics.h"
#include "rt/telemetry/view/view_control.h"
#include "rt/telemetry/view/view_feed.h"
#include "rt/telemetry/view/view_pace.h"

namespace sandrunner {

/// Serves the page and what it shows to browsers of this computer, and topics to Foxglove, from one
/// thread of low ordinary priority. It listens on 127.0.0.1 and ::1 alone. Who has the key, which
/// is part of the address that is printed, may also change things.
class ViewServer {
 public:
  struct Parts {
    const ViewFeed& feed;
    ViewPace* pace = nullptr;  ///< null: the robot has its own time, or there is only a recording
    OperatorDesk* desk = nullptr;    ///< null: pages do not command
    ViewControl* control = nullptr;  ///< null: pages touch neither robot nor ground
    LiveTopics* topics = nullptr;    ///< null: Foxglove does not connect
    bool recorded = false;
  };

  /// Throws InputError if the port is taken. `port` 0: one that is free. All of `parts` must
  /// outlive the server.
  ViewServer(int port, const Parts& parts);
  ~ViewServer();

  /// The address to open, with the key in its fragment, which no browser sends anywhere.
  std::string url() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sandrunner
