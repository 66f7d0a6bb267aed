// SPDX-License-Identifier: BSD-3-Clause
// Random requests, velocities, pushes, stalls and touches of the emergency stop, on several grounds
// and with both kinds of drives: whatever comes, no command breaks the rules of its mode. Runs
// SANDRUNNER_STORM_TICKS ticks (default 120,000).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "disturbed_loop.h"
#include "rt/core/mode_machine.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kEpisode_ticks = 10 * kControlHz;

std::uint64_t storm_ticks() {
  const char* const text = std::getenv("SANDRUNNER_STORM_TICKS");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : 3 * kEpisode_ticks;
}

/// Whether one event of the table, or two in one tick (a request, then a fault), lead there.
bool reachable(Mode from, Mode to) {
  if (from == to) return true;
  for (const Transition& first : kTransitions) {
    if (first.from != from) continue;
    if (first.to == to) return true;
    for (const Transition& second : kTransitions) {
      if (second.from == first.to && second.to == to) return true;
    }
  }
  return false;
}

class RequestStormTest : public testing::Test {
 protected:
  /// One episode from lying; counts what breaks a rule.
  int violations_of(const std::string& terrain, Drives drives, std::uint64_t seed) {
    ProcessConfig config = config_of(terrain, {}, &policy_.spec());
    DisturbedLoop loop(config, policy_, drives);
    sim::Draw draw(seed);
    bool pressed = false;
    loop.robot.spoil = [&](SensorFrame& frame, const SensorFrame&, std::uint64_t) {
      frame.emergency_stop = pressed ? 1 : 0;
    };
    const auto chance = [&](double per_second) { return draw(0.0, 1.0) < per_second / kControlHz; };
    int violations = 0;
    Mode before = Mode::kPassive;
    for (std::uint64_t n = 0; n < kEpisode_ticks; ++n) {
      // Mostly on the way to Walk, else nothing but standing up would be seen.
      if (chance(0.4)) loop.ask(static_cast<ModeRequest>(draw(0.0, 8.99)));
      if (chance(4.0)) {
        loop.ask(before == Mode::kPassive   ? ModeRequest::kArm
                 : before == Mode::kDamping ? ModeRequest::kStand
                 : before == Mode::kFault   ? ModeRequest::kResetFault
                                            : ModeRequest::kWalk);
      }
      if (chance(2.0)) {
        loop.command.velocity = {draw(-5.0, 5.0), draw(-5.0, 5.0), draw(-10.0, 10.0)};
      }
      if (chance(0.2)) loop.simulator.push(draw(-1.0, 1.0), draw(-1.0, 1.0));
      pressed = chance(0.05);
      loop.step(chance(0.2) ? static_cast<std::uint64_t>(draw(1.0, 200.0)) : 0);

      const ControllerOutput& out = loop.record.output;
      const JointCommand& sent = loop.robot.last.joints();
      const bool carries = (kCarrying & mode_set(out.mode)) != 0;
      bool stiff = false;
      for (int j = 0; j < kNumJoints; ++j) {
        stiff = stiff || sent.kp_nmprad[j] != 0.0 || sent.feedforward_nm[j] != 0.0 ||
                sent.velocity_radps[j] != 0.0;
        const double limit_nm = config.robot.model.torque_limit_nm[j];
        if (!(std::fabs(loop.record.truth.joint_torque_nm[j]) <= limit_nm * (1.0 + 1e-12))) {
          ++violations;
        }
      }
      if (stiff && !carries) ++violations;
      if (out.mode == Mode::kPassive && loop.robot.last.enabled()) ++violations;
      if (pressed && (out.faults & fault_bit(Fault::kEmergencyStop)) == 0) ++violations;
      if (out.faults != 0 && out.mode != Mode::kFault) ++violations;
      if (!reachable(before, out.mode)) ++violations;
      ++seen_[static_cast<std::size_t>(out.mode)];
      before = out.mode;
    }
    return violations;
  }

  const Policy policy_ = load_shipped_policy();
  std::array<std::uint64_t, 6> seen_{};
};

TEST_F(RequestStormTest, NoCommandBreaksTheRulesOfItsMode) {
  const std::array<std::string, 4> grounds = {"dry-sand", "rigid", "grass", "wet-sand"};
  std::uint64_t ticks = 0;
  int violations = 0;
  for (std::uint64_t episode = 0; ticks < storm_ticks(); ++episode, ticks += kEpisode_ticks) {
    violations +=
        violations_of(grounds[episode % grounds.size()],
                      episode / 4 % 2 == 0 ? Drives::kGains : Drives::kTorque, episode + 1);
  }
  EXPECT_EQ(violations, 0);
  std::printf("%llu ticks:", static_cast<unsigned long long>(ticks));
  for (std::size_t m = 0; m < seen_.size(); ++m) {
    EXPECT_GT(seen_[m], 0u) << mode_name(static_cast<Mode>(m));
    std::printf(" %s %llu", mode_name(static_cast<Mode>(m)),
                static_cast<unsigned long long>(seen_[m]));
  }
  std::printf("; %d violations\n", violations);
}

}  // namespace
}  // namespace sandrunner
