// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/lockstep.h"

#include <chrono>

#include "rt/base/clock_ns.h"

namespace sandrunner {

Lockstep::Lockstep(RobotIo& robot, const ControllerConfig& config, Mode start, PolicyRunner& policy)
    : policy_(policy), link_(policy), loop_(robot, config, start, link_, clock_) {
  policy_.reset();
}

void Lockstep::tick(const OperatorCommand& command) noexcept {
  loop_.tick({.number = next_tick_++}, command, record_);
}

AfterTick Lockstep::tick(OperatorInput& op, int interrupts) noexcept {
  return loop_.tick({.number = next_tick_++}, op, interrupts, record_);
}

LockstepState Lockstep::state() noexcept {
  LockstepState s;
  s.policy_output = policy_.newest();
  s.controller = loop_.controller().state();
  s.network = policy_.network();
  return s;
}

void Lockstep::add_to(StateHash& hash) noexcept {
  hash.add(policy_.newest());
  hash.add(loop_.controller().state());
  sandrunner::add_to(hash, policy_.network());
}

void Lockstep::restore(const LockstepState& state, std::uint64_t next_tick) noexcept {
  policy_.restore(state.policy_output, state.network);
  loop_.restore(state.controller);
  next_tick_ = next_tick;
}

LoopEnd run_lockstep(const Rig& rig) {
  Lockstep loop(rig.robot, rig.controller, rig.start, rig.policy);
  const std::int64_t start_ns = clock_ns(CLOCK_REALTIME);
  for (TickSink* sink : rig.sinks) sink->begin(start_ns);
  const auto begin = std::chrono::steady_clock::now();
  AfterTick after = AfterTick::kGoOn;
  while (after == AfterTick::kGoOn) {
    after = loop.tick(rig.op, rig.interrupts.load(std::memory_order_relaxed));
    for (TickSink* sink : rig.sinks) sink->add(loop.record());
    if (after == AfterTick::kEnd || !rig.between) continue;
    if (rig.between->act(loop.next_tick(), rig.sinks) == RobotNow::kChanged) loop.robot_changed();
  }
  rig.robot.shut_down();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  for (TickSink* sink : rig.sinks) sink->end();

  LoopEnd end;
  end.time_s = static_cast<double>(loop.next_tick()) * kControlPeriod_s;
  end.realtime_factor = end.time_s / wall.count();
  StateHash hash;
  rig.robot.add_to(hash);
  loop.add_to(hash);
  end.state_hash = hash.value();
  end.gate = loop.controller().state().gate;
  return end;
}

}  // namespace sandrunner
