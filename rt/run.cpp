// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run.h"

#include <chrono>

#include "rt/lockstep.h"
#include "rt/run_recorder.h"
#include "sim/simulator.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kSettle_ticks = kControlHz;  // in Stand, before Walk and at the end
constexpr std::uint64_t kDampingEnd_ticks =
    kControlHz / 2;  // after a fall, a fault or an interrupt
constexpr std::uint64_t kProgress_ticks = kControlHz / 2;

// The operator of a run: which request comes when. One tick at a time, from what the controller
// showed in the last one.
class Operator {
 public:
  Operator(const CommandSource& command, const RunPlan& plan, bool has_policy)
      : source_(command),
        plan_(plan),
        has_policy_(has_policy),
        walk_ticks_(ticks_from_s(plan.walk_s)),
        phase_(plan.start_walking ? Phase::kWalk : Phase::kStandUp) {
    if (phase_ == Phase::kStandUp) request(ModeRequest::kStand);
  }

  /// Command for the tick to come.
  OperatorCommand command(std::uint64_t tick) {
    command_.tick = tick;
    command_.velocity = phase_ == Phase::kWalk
                            ? source_.at(static_cast<double>(walked_) * kControlPeriod_s)
                            : VelocityCommand{};
    return command_;
  }

  /// True if the tick just done belonged to the walk that counts.
  bool walked(Mode mode) const { return phase_ == Phase::kWalk && mode == Mode::kWalk; }

  /// Looks at the mode after a tick and moves on. False: the run is over.
  bool advance(Mode mode) {
    ++in_phase_;
    switch (phase_) {
      case Phase::kStandUp:
        if (mode != Mode::kStand) standing_ = 0;
        if (mode == Mode::kStand && ++standing_ >= kSettle_ticks) {
          if (!has_policy_) return false;
          request(ModeRequest::kWalk);
          enter(Phase::kWalk);
        }
        return true;
      case Phase::kWalk:
        if (mode == Mode::kWalk && ++walked_ >= walk_ticks_) {
          if (plan_.start_walking) return false;
          request(ModeRequest::kStand);
          enter(Phase::kStop);
        }
        return true;
      case Phase::kStop:
        return !(mode == Mode::kStand && ++standing_ >= 2 * kSettle_ticks);
      case Phase::kDamp:
        return in_phase_ < kDampingEnd_ticks;
    }
    return false;
  }

  void damp() {
    if (phase_ == Phase::kDamp) return;
    request(ModeRequest::kDamp);
    enter(Phase::kDamp);
  }
  double walked_s() const { return static_cast<double>(walked_) * kControlPeriod_s; }

 private:
  enum class Phase { kStandUp, kWalk, kStop, kDamp };
  void request(ModeRequest r) {
    command_.request = r;
    ++command_.request_id;
  }
  void enter(Phase phase) {
    phase_ = phase;
    in_phase_ = standing_ = 0;
  }

  const CommandSource& source_;
  const RunPlan plan_;
  const bool has_policy_;
  const std::uint64_t walk_ticks_;
  Phase phase_;
  OperatorCommand command_;
  std::uint64_t in_phase_ = 0, standing_ = 0, walked_ = 0;
};

}  // namespace

RunResult run_lockstep(const ProcessConfig& config, Policy* policy, const CommandSource& command,
                       const RunPlan& plan, bool keep_record, const std::atomic<bool>& interrupt,
                       const std::function<void(const RunSample&)>& progress) {
  sim::Simulator simulator(config.robot, config.simulator);
  if (!plan.start_walking) simulator.reset_lying();
  Lockstep loop(simulator, config.controller, plan.start_walking ? Mode::kWalk : Mode::kPassive,
                policy);
  Operator op(command, plan, policy != nullptr);
  RunStatistics statistics;
  RunResult result;
  RunRecord& record = result.record;
  if (keep_record) {
    record.terrain = config.simulator.terrain.name;
    if (policy) record.policy = policy->spec().name;
    record.granular_ground =
        config.simulator.terrain.patches.front().ground.kind == sim::GroundKind::kGranular;
    const auto& model = simulator.model();
    record.base_box_size_m = {2 * model.base_box_half_m.x, 2 * model.base_box_half_m.y,
                              2 * model.base_box_half_m.z};
    record.base_box_center_m = {model.base_box_centre_m.x, model.base_box_centre_m.y,
                                model.base_box_centre_m.z};
    record.foot_radius_m = model.foot_radius_m;
    if (simulator.terrain().highest > 0.0) {
      record.ground_height_m = [terrain = simulator](double x, double y) {
        return terrain.surface_height(x, y);
      };
    }
  }
  const auto fail = [&](const std::string& reason) {
    // Who interrupts a run lets the robot down: what it touches then is no fall.
    if (!result.survived || result.interrupted) return;
    result.survived = false;
    result.fall_reason = reason;
    result.fall_time_s = op.walked_s();
    op.damp();
  };

  bool has_walked = plan.start_walking;
  GateState gate_before{};
  const auto start = std::chrono::steady_clock::now();
  bool running = true;
  while (running) {
    const std::uint64_t tick = simulator.state().tick;
    const JointArray<double> joint_velocity = simulator.state().robot.rigid.qd;
    const StateEstimate truth = simulator.truth().state;
    loop.tick(op.command(tick));
    const Mode mode = loop.output().mode;
    const GateState& gate = loop.controller().state().gate;
    has_walked = has_walked || mode == Mode::kWalk;
    if (op.walked(mode)) {
      statistics.add({.simulator = simulator,
                      .joint_velocity_radps = joint_velocity,
                      .command = loop.output().policy_input.command,
                      .policy_ran = loop.policy_ran(),
                      .estimate = loop.policy_output().estimate,
                      .truth = truth,
                      .joint_past_stop = gate.joint_limit_ticks != gate_before.joint_limit_ticks,
                      .joint_too_fast = gate.speed_limit_ticks != gate_before.speed_limit_ticks});
    }
    gate_before = gate;
    if (tick % kTicksPerPolicyStep == 0 && (keep_record || tick % kProgress_ticks == 0)) {
      const RunSample sample = make_sample(simulator, loop, truth);
      if (keep_record) record.samples.push_back(sample);
      if (tick % kProgress_ticks == 0 && progress) progress(sample);
    }
    if (loop.output().faults != 0) fail(fault_name(gate.first_fault));
    // Lying and standing up, base and thighs only carry; once the robot has walked, touching the
    // ground is a fall.
    const sim::StepReport<double>& report = simulator.truth().report;
    if (has_walked && report.base_contact > 0.0) fail("base_contact");
    if (has_walked && report.thigh_contact > 0.0) fail("thigh_contact");
    if (interrupt.load(std::memory_order_relaxed)) {
      result.interrupted = true;
      op.damp();
    }
    running = op.advance(mode);
    if (!has_walked && mode == Mode::kStand && (!running || loop.output().mode == Mode::kWalk) &&
        report.base_contact > 0.0) {
      fail("did_not_stand");
    }
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;

  result.walked_s = op.walked_s();
  result.simulated_s = static_cast<double>(simulator.state().tick) * kControlPeriod_s;
  result.realtime_factor = result.simulated_s / wall.count();
  StateHash hash;
  simulator.add_to(hash);
  loop.add_to(hash);
  result.state_hash = hash.value();
  result.figures = statistics.figures(simulator.model().mass(), config.motor_constant);
  if (keep_record) record.footprints = statistics.footprints();
  return result;
}

}  // namespace sandrunner
