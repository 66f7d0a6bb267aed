// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "rt/loop/policy_runner.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// The first thing that a replay found to differ from its recording.
struct ReplayDifference {
  std::uint64_t tick = 0;
  std::string what;  ///< field, recorded and computed value
};

/// Ticks that are missing before `recorded` in a recording that should go on with `next_tick`.
/// Slots that the loop skipped are not missing.
inline std::uint64_t missing_before(const TickRecord& recorded, std::uint64_t next_tick) noexcept {
  const std::uint64_t tick = recorded.input.sensors.tick, expected = next_tick + recorded.skipped;
  return tick > expected ? tick - expected : 0;
}

/// All that a replay carries over from tick to tick: with it, a recording that begins in the middle
/// of a run replays like a whole one. All members are free of padding.
struct ReplayState {
  /// The policy answers within three releases or the controller faults: eight are plenty. Of more,
  /// the newest count.
  static constexpr std::size_t kMostReleased = 8;

  ControllerState controller;
  NetworkState network;
  PolicyOutput newest;          ///< of the policy
  std::uint64_t next_tick = 0;  ///< that the controller will step
  std::uint64_t released = 0;   ///< of `inputs`: not known to be answered, in their order
  std::array<PolicyInput, kMostReleased> inputs{};
};
static_assert(std::is_trivially_copyable_v<ReplayState>);
static_assert(sizeof(ReplayState) == sizeof(ControllerState) + sizeof(NetworkState) +
                                         sizeof(PolicyOutput) + 16 +
                                         ReplayState::kMostReleased * sizeof(PolicyInput),
              "no padding");

/// The state as bytes of a file: "SRSTATE1", their number (64 bits), the state.
std::string replay_state_bytes(const ReplayState& state);
/// The reverse. `name` (of the file and the part) stands in the InputError for bytes that are none.
ReplayState read_replay_state(std::string_view bytes, const std::string& name);

/// Feeds recorded inputs through the step functions again and compares what they give, bit by bit.
/// It computes, it copies nothing: the controller and the network start where the recorded ones
/// did, or from a state.
class Replay {
 public:
  /// `policy`: that of the run.
  Replay(const ControllerConfig& config, Mode start, PolicyRunner policy);

  /// One recorded tick, in order: policy output, controller output and gate counters are compared.
  /// Returns the first difference; nothing if all agrees. Behind missing ticks (missing_before())
  /// nothing can be compared until a state is restored: that is for the caller to detect, and a
  /// record with a wrong tick is a difference here.
  std::optional<ReplayDifference> check(const TickRecord& recorded);

  /// Before the next tick. After a difference it is not that of the recorded run any more.
  ReplayState state() const noexcept;
  void restore(const ReplayState& state);

  /// What the step functions gave for the tick checked last.
  const ControllerOutput& output() const noexcept { return output_; }
  std::uint64_t ticks() const noexcept { return ticks_; }
  std::uint64_t next_tick() const noexcept { return next_tick_; }
  std::uint64_t policy_steps() const noexcept { return policy_steps_; }

 private:
  std::optional<ReplayDifference> check_policy(const TickRecord& recorded);

  Controller controller_;
  PolicyRunner policy_;
  ControllerOutput output_;
  std::vector<PolicyInput> released_;  // not known to be answered
  std::uint64_t next_tick_ = 0, ticks_ = 0, policy_steps_ = 0;
};

}  // namespace sandrunner
