// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "rt/operator/command_gate.h"
#include "rt/operator/mode_requests.h"
#include "rt/operator/remote_operator.h"

namespace sandrunner {

/// Who asks: a participant of DDS, a page of the view.
using OperatorId = std::array<std::uint8_t, 16>;

/// Why what an operator asks for is refused while another one holds the velocity.
inline constexpr const char* kOtherOperator = "another operator drives the robot";

/// What became of a request.
struct RequestOutcome {
  bool accepted = false;
  std::string text;  ///< "mode stand_up", or why not
};

/// What became of the commands since the start.
struct CommandCounts {
  std::uint64_t accepted = 0;  ///< velocity commands
  std::uint64_t not_finite = 0, absurd = 0, other_publisher = 0, objected = 0;  ///< refused ones
  std::uint64_t requests_accepted = 0, requests_refused = 0;
};

/// Where all that operators ask for comes together, by whatever way, in front of the control
/// thread. One of them holds the velocity command; while one does, requests are accepted from
/// that operator alone, but for stop and damp, which anybody may ask for. For ordinary threads, any
/// number of them. While one waits for the controller's answer, stop and damp, velocities and the
/// counts do not wait behind it.
class OperatorDesk {
 public:
  /// Why nothing that may move the robot is to be accepted by this way now; empty: nothing.
  using Objection = std::function<std::string()>;

  /// `op` must outlive the desk. `stale_s`: a velocity older than this holds nothing any more.
  /// `no_walk`: why the robot may not walk; null: it may. `answer`: the controller answers within a
  /// tick; a busy computer holds a thread that is not real-time up for some tens of ms; what has
  /// not answered after this time is not running.
  OperatorDesk(RemoteOperator& op, double stale_s, const char* no_walk,
               std::chrono::milliseconds answer = std::chrono::milliseconds(100));

  /// A velocity. `publisher`: what `who` sends it with. One that is objected to holds nothing.
  CommandVerdict drive(const Twist& twist, std::uint64_t publisher, const OperatorId& who,
                       const Objection& objection = {});

  /// A mode request; waits for the controller's answer. `objection` is asked about what does not
  /// end the motion.
  RequestOutcome request(std::string_view name, const OperatorId& who,
                         const Objection& objection = {});

  Mode mode() const noexcept { return operator_.mode(); }
  const char* no_walk() const noexcept { return no_walk_; }
  CommandCounts counts() const;
  /// The latest mode request and what became of it; empty: none yet.
  std::string last_request() const;

 private:
  using Lock = std::unique_lock<std::mutex>;
  using Time = std::chrono::steady_clock::time_point;

  // Why not; empty: done. `lock` is of `mutex_`, and given up while it waits. `objected`: the
  // objection's.
  std::string follow(std::string_view name, const OperatorId& who, const std::string& objected,
                     Lock& lock);
  // Waits until the controller has considered the request of this number; false: in vain.
  bool wait_for(std::uint64_t number, Time deadline, Lock& lock) const;

  RemoteOperator& operator_;
  const char* const no_walk_;
  const std::chrono::milliseconds answer_;
  std::mutex one_by_one_;     // of requests that do not end the motion, until they are answered
  mutable std::mutex mutex_;  // of all that follows; locked behind the other, and never for long
  CommandGate gate_;
  OperatorId holder_{};  // of the velocity that was accepted last
  OperatorRequests asked_;
  std::uint64_t calming_number_ = 0;  // of the latest stop or damp
  Time calming_deadline_{};           // when it should have been considered
  CommandCounts counts_;
  std::string last_request_;
};

}  // namespace sandrunner
