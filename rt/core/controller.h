// SPDX-License-Identifier: BSD-3-Clause
// One step of the 4 kHz controller. It has no clock, thread or file: time is the tick of the
// sensors, and all that it remembers is a ControllerState, so that a run replays from its recorded
// inputs.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "rt/core/command_shaping.h"
#include "rt/core/messages.h"
#include "rt/core/mode_machine.h"
#include "rt/core/robot_io.h"
#include "rt/core/safety_gate.h"

namespace sandrunner {

// What a robot or a policy gives is 0 here: without them nothing moves. The other values are
// choices of this project, tried in simulation. Settings of the same names override both,
// but for postures, `skip_fold_rad` and `latency_ticks`, which is policy.latency_ticks
// (rt/README.md).

/// Walk: joint targets of the policy with the policy's gains.
struct WalkConfig {
  double kp_nmprad = 0.0;   ///< from the policy's file
  double kd_nmsprad = 0.0;  ///< from the policy's file
  /// A policy output takes effect this many ticks after its input was sampled, 1 to 39; one that
  /// comes later takes effect at once and counts as late.
  std::uint64_t latency_ticks = 1;
  // When Stand is requested, the command slows down to zero, the policy comes to rest, and then
  // Stand takes over.
  double stop_deceleration_mps2 = 1.0;        ///< of vx and of vy; the policy's at most
  double stop_yaw_deceleration_radps2 = 1.0;  ///< of the yaw rate; likewise
  double stop_speed_radps = 1.0;  ///< at rest: no joint and no body axis turns faster ...
  double stop_calm_s = 0.25;      ///< ... for this long
  double stop_time_s = 3.0;       ///< at zero command: longest wait for that rest
};

/// StandUp and Stand.
struct StandConfig {
  double kp_nmprad = 0.0;   ///< from the robot's file
  double kd_nmsprad = 0.0;  ///< from the robot's file
  /// StandUp: its stiffness rises from zero over this time, and the first of its motions lasts no
  /// less. For the first tests of a robot: a wrong sign or scale shows before the drives are
  /// strong.
  double gain_ramp_s = 0.0;
  /// Posture of Stand, also at the end of its blend from Walk. From the robot's file.
  JointArray<double> nominal_rad{};
  /// Posture of each leg before it extends. From the robot's file.
  std::array<double, kJointsPerLeg> fold_rad{};
  double fold_s = 1.0;         ///< time to fold the legs
  double extend_s = 1.5;       ///< time to extend them to the nominal posture
  double skip_fold_rad = 0.3;  ///< no folding if all joints are nearer than this to nominal
  /// Time from the posture in Walk to that of Stand. The body may have come to rest 0.15 m from
  /// where Stand wants it, on feet that lie in sand: in 0.5 s it is moved at up to 0.65 m/s, and
  /// topples there.
  double blend_s = 1.5;
  /// Of the targets; where they would be faster, the times above become longer.
  double max_speed_radps = 4.0;
  // Stand is reached when no joint is farther than this from its target; a fault if that is not so
  // after this time.
  double reached_rad = 0.25;
  double reach_s = 1.0;
};

/// Damping and the damping after a fault.
struct DampingConfig {
  LegJoints<double> kd_nmsprad{};  ///< from the robot's file
  double fault_s = 2.0;            ///< after a fault: damping for this long, then drives off
};

/// Shaping of the velocity command, and what becomes of a robot whose operator is lost.
struct ShapingConfig {
  CommandEnvelope envelope;  ///< from the policy's file
  double centripetal_limit_mps2 = kCentripetalLimit_mps2;
  /// After this time without a sign of life of the operator, the command is zero. 0: such an
  /// operator cannot be lost, and the other two do not act.
  std::uint64_t operator_hold_ticks = 0;
  double operator_stand_s = 10.0;  ///< then a walking robot stops and stands
  double operator_down_s = 120.0;  ///< then a standing robot lies down
};

struct ControllerConfig {
  WalkConfig walk;
  StandConfig stand;
  DampingConfig damping;
  ShapingConfig shaping;
  GateConfig gate;
};

/// All that the controller remembers; a copy is a snapshot. All members are 64 bits wide: no
/// padding.
struct ControllerState {
  Mode mode = Mode::kPassive;
  std::uint64_t entered = 0;       ///< 1 once the first step has entered `mode`
  std::uint64_t request_id = 0;    ///< latest request that was considered
  std::uint64_t disable_tick = 0;  ///< Fault: when the drives go off
  std::uint64_t fault_steps = 0;   ///< Fault: steps in it, as time may stand still

  // Motion of StandUp and Stand: from `from_rad` to `to_rad` between two ticks.
  JointArray<double> from_rad{};
  JointArray<double> to_rad{};
  std::uint64_t motion_start_tick = 0;
  std::uint64_t motion_ticks = 0;
  /// 1 in the first phase of StandUp; in Stand from the beginning of a lowering to its end, or
  /// until it has risen again.
  std::uint64_t folding = 0;

  // Stand.
  Vector3 stood_up{};        ///< the vertical in the body's frame, when its motion had ended
  std::uint64_t stands = 0;  ///< 1: it has
  std::uint64_t leans_since_tick = 0;       ///< since when the body has leaned away from that
  std::array<double, kNumLegs> knee_nm{};   ///< low-passed torques while the robot carries itself
  std::array<double, kNumLegs> stood_nm{};  ///< these after half a second of Stand
  std::uint64_t stood_ticks = 0;            ///< of that half second

  // Walk.
  VelocityCommand command;     ///< inside the envelope, after the slew, before the yaw clip
  double command_share = 1.0;  ///< of what was asked that the envelope leaves
  /// 1 after a request of Stand or stop; 2 after one to lie down, also in Stand.
  std::uint64_t stopping = 0;
  /// Bits of Warning that hold, or have held since the robot carries itself.
  std::uint64_t warnings = 0;
  std::uint64_t zero_since_tick = 0;  ///< while stopping: since when the command has been zero
  std::uint64_t restless_tick = 0;    ///< while stopping: when something last moved
  std::uint64_t episode = 0;
  std::uint64_t next_policy_slot = 0;  ///< the policy is released when tick / 40 reaches this
  JointArray<double> target_rad{};     ///< in use
  std::uint64_t policy_sequence = 0;   ///< of the output in use; 0: none yet
  std::uint64_t policy_input_tick =
      0;  ///< of the output in use; before the first one, start of Walk
  std::uint64_t late_policy_outputs = 0;  ///< since the start

  GateState gate;
};
static_assert(std::is_trivially_copyable_v<ControllerState>);
static_assert(sizeof(ControllerState) ==
                  8 * (27 + 3 * kNumJoints + 2 * kNumLegs) + sizeof(GateState),
              "no padding");

struct ControllerInput {
  SensorFrame sensors;
  PolicyOutput policy;  ///< newest one; the same one may be given any number of times
  OperatorCommand command;
};

struct ControllerOutput {
  SafeCommand command;
  PolicyInput policy_input;
  /// 1 in Walk on every 40th tick (or the first one after it, if that was skipped): run the policy
  /// on `policy_input`. Else 0.
  std::uint64_t release_policy = 0;
  Mode mode = Mode::kPassive;
  std::uint64_t faults = 0;          ///< latched bits of Fault
  Fault first_fault = Fault::kNone;  ///< that began the latest latch
  std::uint64_t fault_joints = 0;    ///< that it is about, bit j for joint j
  std::uint64_t warnings = 0;        ///< bits of Warning for which the robot lies down
  /// Walk: how much of the operator's command the policy's envelope leaves (EnvelopedCommand); else
  /// 1.
  double command_share = 1.0;
};
static_assert(std::is_trivially_copyable_v<ControllerInput>);
static_assert(std::is_trivially_copyable_v<ControllerOutput>);

class Controller {
 public:
  /// `config` must be sensible (finite, times, gains and thresholds not negative); it is not
  /// checked here. `start` is entered by the first step, which leaves requests to the second:
  /// Passive, or Walk for a simulated robot that starts on its feet.
  explicit Controller(const ControllerConfig& config, Mode start = Mode::kPassive);

  /// One tick. `input.sensors.tick` must grow from call to call; ticks may be skipped.
  void step(const ControllerInput& input, ControllerOutput& output) noexcept;

  const ControllerState& state() const noexcept { return state_; }
  void restore(const ControllerState& state) noexcept { state_ = state; }

 private:
  Mode after_request(const OperatorCommand& command, std::uint64_t tick) noexcept;
  Mode after_time(Mode mode, const ControllerInput& input) noexcept;
  Mode lie(Mode mode, std::uint64_t tick) noexcept;
  void begin_stop(std::uint64_t tick) noexcept;
  void begin_lowering(std::uint64_t tick) noexcept;
  void pause_motion(std::uint64_t tick) noexcept;
  void yield_to_heat(const JointState& joints) noexcept;
  void watch_lean(const ImuSample& imu, std::uint64_t tick) noexcept;
  void watch_load(const JointState& joints) noexcept;
  bool drives_on(std::uint64_t tick) const noexcept;
  bool standing(const SensorFrame& sensors) const noexcept;
  std::uint64_t lost_ticks(const OperatorCommand& command, std::uint64_t tick) const noexcept;
  void enter(Mode mode, const SensorFrame& sensors) noexcept;
  void start_motion(const JointArray<double>& from_rad, const JointArray<double>& to_rad,
                    double duration_s, std::uint64_t tick) noexcept;
  void continue_stand_up(std::uint64_t tick) noexcept;
  void take_policy(const PolicyOutput& policy, std::uint64_t tick) noexcept;
  VelocityCommand shape(const OperatorCommand& command, std::uint64_t tick) noexcept;
  bool at_rest(const SensorFrame& sensors) const noexcept;
  double stiffness_share(std::uint64_t tick) const noexcept;
  JointCommand motion_command(std::uint64_t tick) const noexcept;
  JointCommand walk_command() const noexcept;
  bool motion_done(std::uint64_t tick) const noexcept {
    return tick - state_.motion_start_tick >= state_.motion_ticks;
  }

  ControllerConfig config_;
  SafetyGate gate_;
  JointArray<double> fold_rad_;
  double max_step_mps_;  // of the slew, in one tick
  double max_step_radps_;
  double stop_step_mps_;  // of the slew while stopping
  double stop_step_radps_;
  double least_stood_n2m2_ = 0.0;  // of the knees in Stand, or they say nothing of a lift
  ControllerState state_;
};

}  // namespace sandrunner
