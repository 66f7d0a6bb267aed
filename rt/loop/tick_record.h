// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "rt/core/controller.h"
#include "rt/loop/operator_input.h"
#include "sim/simulator.h"

namespace sandrunner {

/// What really happened in the simulator in one tick; nothing on a real robot.
struct SimulatedTick {
  JointArray<double> joint_velocity_before_radps{};
  StateEstimate truth_before;  ///< what the estimate of this tick's sensors should be
  // After the tick:
  sim::RigidState<double> robot;
  JointArray<double> torque_nm{};
  StateEstimate truth;
  std::array<sim::Vec3<double>, kNumLegs> foot_centre{};  ///< world, m
  std::array<double, kNumLegs> penetration_m{};           ///< of the contact points
};

/// How long the parts of a tick took; all zero in lockstep.
struct TickTiming {
  std::int64_t late_ns = 0;     ///< start after the slot's time
  std::int64_t read_ns = 0;     ///< RobotIo::read
  std::int64_t control_ns = 0;  ///< Controller::step and the exchange with the policy
  std::int64_t write_ns = 0;    ///< RobotIo::write: the bus, or the simulator's step
};

/// One control tick as it is handed to ordinary threads: inputs and outputs of the step functions
/// complete, so that it can be replayed.
struct TickRecord {
  ControllerInput input;
  ControllerOutput output;
  std::uint64_t counts = 0;  ///< 1: belongs to the walk that the figures are taken over
  std::uint64_t joint_past_stop = 0, joint_too_fast = 0;  ///< 1: some joint is, in this tick
  std::uint64_t skipped = 0;                              ///< slots missed directly before it
  TickTiming timing;
  SimulatedTick simulated;
};
static_assert(std::is_trivially_copyable_v<TickRecord>);

/// Before the tick: what it starts from.
inline void note_before(const sim::Simulator& simulator, TickRecord& record) noexcept {
  record.simulated.joint_velocity_before_radps = simulator.state().robot.rigid.qd;
  record.simulated.truth_before = simulator.truth().state;
}

/// After the tick: what the robot did.
inline void note_after(const sim::Simulator& simulator, TickRecord& record) noexcept {
  SimulatedTick& s = record.simulated;
  s.robot = simulator.state().robot.rigid;
  s.torque_nm = simulator.state().torque_nm;
  s.truth = simulator.truth().state;
  s.foot_centre = simulator.truth().report.foot_centre;
  s.penetration_m = simulator.truth().report.penetration;
}

/// Whether a joint was past its stop or too fast in the tick between two states of the gate.
inline void note_gate(const GateState& before, const GateState& after,
                      TickRecord& record) noexcept {
  record.joint_past_stop = after.joint_limit_ticks != before.joint_limit_ticks ? 1 : 0;
  record.joint_too_fast = after.speed_limit_ticks != before.speed_limit_ticks ? 1 : 0;
}

/// Adds what the simulated robot touches.
inline void note_contacts(const sim::Simulator& simulator, TickFacts& facts) noexcept {
  const sim::StepReport<double>& report = simulator.truth().report;
  facts.base_contact = report.base_contact > 0.0;
  facts.thigh_contact = report.thigh_contact > 0.0;
}

}  // namespace sandrunner
