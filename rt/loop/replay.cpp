// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <utility>

#include "rt/base/errors.h"
#include "rt/loop/tick_fields.h"

namespace sandrunner {
namespace {

constexpr std::string_view kStateMagic = "SRSTATE1";
constexpr std::size_t kStateHead_bytes = 16;
// What a TCN or a perceptron remembers follows the rest, and only if there is something.
constexpr std::size_t kPastAt = offsetof(ReplayState, network) + offsetof(NetworkState, past);
constexpr std::size_t kPerceptronAt = kPastAt + sizeof(TcnPast);
constexpr std::size_t kRestAt = kPerceptronAt + sizeof(PerceptronPast);
constexpr std::size_t kUsual_bytes = sizeof(ReplayState) - (kRestAt - kPastAt);
static_assert(sizeof(TcnPast) != sizeof(PerceptronPast), "their size says which");

/// Place and size of what the network remembers besides the rest.
struct Memory {
  std::size_t at = kPastAt, bytes = 0;
};
constexpr Memory kMemories[] = {
    {}, {kPastAt, sizeof(TcnPast)}, {kPerceptronAt, sizeof(PerceptronPast)}};

Memory memory_of(const NetworkState& network) {
  return kMemories[network.past.steps > 0 ? 1 : network.perceptron.steps > 0 ? 2 : 0];
}

std::string value_of(std::size_t word, std::uint64_t bits) {
  return tick_field_of(word).kind == 'd'
             ? fmt::format("{:.17g} ({:016x})", std::bit_cast<double>(bits), bits)
             : fmt::format("{}", bits);
}

// Compares the words [from, from + count) of two records.
std::optional<ReplayDifference> first_difference(const TickRecord& recorded,
                                                 const TickRecord& computed, std::size_t from_byte,
                                                 std::size_t bytes) {
  const auto a = std::bit_cast<TickWords>(recorded), b = std::bit_cast<TickWords>(computed);
  for (std::size_t i = from_byte / 8; i < (from_byte + bytes) / 8; ++i) {
    if (a[i] == b[i]) continue;
    return ReplayDifference{recorded.input.sensors.tick,
                            fmt::format("{}: recorded {}, computed {}", tick_word_name(i),
                                        value_of(i, a[i]), value_of(i, b[i]))};
  }
  return std::nullopt;
}

}  // namespace

std::string replay_state_bytes(const ReplayState& state) {
  const Memory memory = memory_of(state.network);
  const std::uint64_t size = kUsual_bytes + memory.bytes;
  const char* const at = reinterpret_cast<const char*>(&state);
  std::string bytes(kStateMagic);
  bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
  bytes.append(at, kPastAt).append(at + kRestAt, sizeof state - kRestAt);
  bytes.append(at + memory.at, memory.bytes);
  return bytes;
}

ReplayState read_replay_state(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with(kStateMagic)) {
    throw InputError(
        fmt::format("{}: does not begin with {}: found no state of a replay", name, kStateMagic));
  }
  ReplayState state;
  std::uint64_t size = 0;
  if (bytes.size() >= kStateHead_bytes) std::memcpy(&size, &bytes[kStateMagic.size()], sizeof size);
  const auto memory = std::ranges::find_if(
      kMemories, [&](const Memory& m) { return size == kUsual_bytes + m.bytes; });
  if (memory == std::end(kMemories) || bytes.size() != kStateHead_bytes + size) {
    throw InputError(
        fmt::format("{}: {} bytes that announce {}, expected {} and {}: damaged, or "
                    "of a build that lays the state out otherwise",
                    name, bytes.size(), size, kStateHead_bytes + kUsual_bytes, kUsual_bytes));
  }
  char* const to = reinterpret_cast<char*>(&state);
  const char* const from = bytes.data() + kStateHead_bytes;
  std::memcpy(to, from, kPastAt);
  std::memcpy(to + kRestAt, from + kPastAt, sizeof state - kRestAt);
  std::memcpy(to + memory->at, from + kUsual_bytes, memory->bytes);
  if (state.released > ReplayState::kMostReleased || state.controller.mode > Mode::kFault) {
    throw InputError(
        fmt::format("{}: mode {} and {} inputs of the policy, expected up to {} and {}", name,
                    static_cast<std::uint64_t>(state.controller.mode), state.released,
                    static_cast<std::uint64_t>(Mode::kFault), ReplayState::kMostReleased));
  }
  return state;
}

Replay::Replay(const ControllerConfig& config, Mode start, PolicyRunner policy)
    : controller_(config, start), policy_(std::move(policy)) {
  policy_.reset();
}

std::optional<ReplayDifference> Replay::check(const TickRecord& recorded) {
  const std::uint64_t tick = recorded.input.sensors.tick;
  const std::uint64_t expected = next_tick_ + recorded.skipped;
  if (tick != expected) {
    return ReplayDifference{tick, fmt::format("tick: recorded {}, expected {}", tick, expected)};
  }
  next_tick_ = tick + 1;
  if (auto difference = check_policy(recorded)) return difference;

  controller_.step(recorded.input, output_);
  ++ticks_;
  if (output_.release_policy != 0 && !policy_.is_none()) released_.push_back(output_.policy_input);
  TickRecord computed = recorded;
  computed.output = output_;
  computed.counters = controller_.state().gate.counters;
  static_assert(offsetof(TickRecord, counters) ==
                offsetof(TickRecord, output) + sizeof(ControllerOutput));
  return first_difference(recorded, computed, offsetof(TickRecord, output),
                          sizeof(ControllerOutput) + sizeof(GateCounters));
}

ReplayState Replay::state() const noexcept {
  ReplayState s;
  s.controller = controller_.state();
  s.network = policy_.network();
  s.newest = policy_.newest();
  s.next_tick = next_tick_;
  s.released = std::min(released_.size(), ReplayState::kMostReleased);
  std::copy(released_.end() - static_cast<std::ptrdiff_t>(s.released), released_.end(),
            s.inputs.begin());
  return s;
}

void Replay::restore(const ReplayState& state) {
  controller_.restore(state.controller);
  policy_.restore(state.newest, state.network);
  next_tick_ = state.next_tick;
  released_.assign(state.inputs.begin(),
                   state.inputs.begin() + static_cast<std::ptrdiff_t>(state.released));
}

std::optional<ReplayDifference> Replay::check_policy(const TickRecord& recorded) {
  const PolicyOutput& answer = recorded.input.policy;
  const std::uint64_t answered = policy_.newest().sequence;
  if (answer.sequence > answered) {
    // Which of the released inputs it answers stands in it. Answers that were overtaken before the
    // control thread looked have taken the inputs before that one.
    const auto last = std::find_if(released_.begin(), released_.end(), [&](const PolicyInput& in) {
      return in.tick == answer.input_tick;
    });
    const auto before = static_cast<std::uint64_t>(last - released_.begin());
    const std::uint64_t unseen = answer.sequence - answered - 1;
    if (last == released_.end() || unseen > before) {
      return ReplayDifference{
          recorded.input.sensors.tick,
          fmt::format("policy_input_tick: recorded {}, which was not released", answer.input_tick)};
    }
    for (auto input = last - static_cast<std::ptrdiff_t>(unseen); input <= last; ++input) {
      policy_.step(*input);
      ++policy_steps_;
    }
    released_.erase(released_.begin(), last + 1);
  }
  TickRecord computed = recorded;
  computed.input.policy = policy_.newest();
  return first_difference(recorded, computed, offsetof(TickRecord, input.policy),
                          sizeof(PolicyOutput));
}

}  // namespace sandrunner
