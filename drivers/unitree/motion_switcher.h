// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "rt/dds/participant.h"

namespace sandrunner::unitree {

inline constexpr const char* kSwitcherRequests = "rt/api/motion_switcher/request";
inline constexpr const char* kSwitcherResponses = "rt/api/motion_switcher/response";

/// Requests to the service motion_switcher, by their number.
enum class SwitcherRequest : std::int64_t { kCheckMode = 1001, kReleaseMode = 1003 };

/// The name in the answer to kCheckMode, {"form":"0","name":"ai"}; empty: no program of the robot's
/// own controls it; none: the text is no such answer.
std::optional<std::string> mode_name(const std::string& json);

/// The client of the robot's service that says which of the robot's own programs controls it
/// (sport mode), and that switches it off.
class MotionSwitcher {
 public:
  struct Answer {
    std::int32_t code = 0;  ///< 0: done
    std::string data;       ///< JSON
  };

  /// Throws InputError.
  explicit MotionSwitcher(const DdsParticipant& participant);

  /// Sends a request, in place of one that is not answered yet.
  void send(SwitcherRequest request);
  /// The answer to the last request, once.
  std::optional<Answer> take();
  /// Sends a request again and again, as none is kept for a service that joins later, and waits
  /// for an answer, `pause` between two looks; none: it does not come within `timeout_s`.
  std::optional<Answer> ask(SwitcherRequest request, double timeout_s,
                            const std::function<void()>& pause);

 private:
  dds_entity_t requests_, responses_;
  std::int64_t id_ = 0;
};

}  // namespace sandrunner::unitree
