// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/run_script.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kSettle_ticks = kControlHz;  // in Stand before Walk; twice that at the end

}  // namespace

RunScript::RunScript(const CommandSource& command, const RunPlan& plan, bool can_walk)
    : source_(command),
      plan_(plan),
      can_walk_(can_walk),
      walk_ticks_(ticks_from_s(plan.walk_s)),
      phase_(plan.start_walking ? Phase::kWalk : Phase::kArm),
      has_walked_(plan.start_walking),
      fall_mode_(plan.start_walking ? Mode::kWalk : Mode::kPassive) {
  if (phase_ == Phase::kArm) command_.ask(ModeRequest::kArm);
}

OperatorCommand RunScript::command(std::uint64_t tick) noexcept {
  command_.tick = tick;
  command_.velocity = phase_ == Phase::kWalk ? source_.at(walked_s()) : VelocityCommand{};
  return command_;
}

OperatorVerdict RunScript::advance(const TickFacts& facts) noexcept {
  OperatorVerdict verdict;
  const Phase at_start = phase_;
  if (!fall_reason_ && facts.mode != Mode::kFault) fall_mode_ = facts.mode;
  has_walked_ = has_walked_ || facts.mode == Mode::kWalk;
  verdict.counts = phase_ == Phase::kWalk && facts.mode == Mode::kWalk;
  if (facts.faults != 0) fail(fault_name(facts.first_fault), kAtOnce);
  if (facts.warnings != 0) fail(warning_name(facts.warnings), kGently);
  // Lying and standing up, base and thighs only carry; once the robot has walked, touching the
  // ground is a fall, but not while it lies down.
  const bool carries = has_walked_ && phase_ != Phase::kEnd;
  if (carries && facts.base_contact) fail("base_contact", kAtOnce);
  if (carries && facts.thigh_contact) fail("thigh_contact", kAtOnce);
  if (facts.interrupts > 0) {
    interrupted_ = true;
    end(end_.lie());
  }
  if (facts.interrupts > 1) end(end_.damp());
  const Phase before = phase_;
  // What was skipped lies before the end that this tick begins: a stall does not shorten it.
  verdict.next = next_phase(facts.mode, phase_ == at_start ? facts.ticks : 1);
  const bool stood_up = before == Phase::kStandUp && phase_ != Phase::kStandUp;
  if (stood_up && facts.base_contact) fail("did_not_stand", kAtOnce);
  return verdict;
}

AfterTick RunScript::next_phase(Mode mode, std::uint64_t ticks) noexcept {
  switch (phase_) {
    case Phase::kArm:
      if (mode == Mode::kDamping) {
        command_.ask(ModeRequest::kStand);
        enter(Phase::kStandUp);
      }
      return AfterTick::kGoOn;
    case Phase::kStandUp:
      if (mode != Mode::kStand) standing_ = 0;
      if (mode == Mode::kStand && (standing_ += ticks) >= kSettle_ticks) {
        if (can_walk_) {
          command_.ask(ModeRequest::kWalk);
          enter(Phase::kWalk);
        } else {
          end(end_.lie());
        }
      }
      return AfterTick::kGoOn;
    case Phase::kWalk:
      if (mode == Mode::kWalk && (walked_ += ticks) >= walk_ticks_) {
        if (plan_.start_walking) return AfterTick::kEnd;
        command_.ask(ModeRequest::kStand);
        enter(Phase::kStop);
      }
      return AfterTick::kGoOn;
    case Phase::kStop:
      if (mode == Mode::kStand && (standing_ += ticks) >= 2 * kSettle_ticks) end(end_.lie());
      return AfterTick::kGoOn;
    case Phase::kEnd:
      end(end_.advance(mode, ticks));
      return end_.done() ? AfterTick::kEnd : AfterTick::kGoOn;
  }
  return AfterTick::kEnd;
}

void RunScript::enter(Phase phase) noexcept {
  phase_ = phase;
  standing_ = 0;
}

void RunScript::end(ModeRequest r) noexcept {
  if (r == ModeRequest::kNone) return;
  command_.ask(r);
  enter(Phase::kEnd);
}

void RunScript::fail(const char* reason, WayDown way) noexcept {
  // Who interrupts a run lets the robot down: a fault on the way is no fall. After a warning it is.
  if ((fall_reason_ && !(warned_ && way == kAtOnce)) || interrupted_) return;
  warned_ = way == kGently;
  fall_reason_ = reason;
  fall_time_s_ = walked_s();
  end(way == kAtOnce ? end_.damp() : end_.lie());
}

}  // namespace sandrunner
