// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <memory>
#include <thread>

#include "rt/loop/lockstep.h"
#include "rt/realtime/clock.h"
#include "rt/report/run_observer.h"
#include "rt/run/run.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kLeadTime_ns = 20'000'000;  // from the last set-up to slot 0
constexpr auto kDrainEvery = std::chrono::milliseconds(5);

// Both real-time threads, held until they are set up, and joined in whatever way the run ends: the
// robot is let down first.
class Threads {
 public:
  Threads(ControlThread& control, PolicyThread* policy, const RealtimeHooks& hooks,
          std::atomic<bool>& end)
      : policy_loop_(policy), end_(end) {
    control_ = std::thread([this, &control, &hooks] {
      prepare_this_thread();
      start_.wait(0);
      if (start_ > 0) control.run(start_, hooks.control);
      done_ = true;
    });
    if (!policy) return;
    policy_ = std::thread([this, policy, &hooks] {
      prepare_this_thread();
      start_.wait(0);
      if (start_ > 0) policy->run(start_, hooks.policy);
    });
  }
  ~Threads() {
    end_ = true;
    std::int64_t unset = 0;
    if (start_.compare_exchange_strong(unset, -1)) start_.notify_all();
    control_.join();
    if (policy_loop_) policy_loop_->stop();
    if (policy_.joinable()) policy_.join();
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  void set_up(RealtimeSetup& setup) {
    setup.adopt_control_thread(control_.native_handle());
    if (policy_.joinable()) setup.adopt_policy_thread(policy_.native_handle());
  }
  void start() {
    start_ = monotonic_ns() + kLeadTime_ns;
    start_.notify_all();
  }
  bool done() const noexcept { return done_; }

 private:
  PolicyThread* policy_loop_;
  std::atomic<bool>& end_;
  std::atomic<std::int64_t> start_{0};  // CLOCK_MONOTONIC of slot 0; -1: do not start
  std::atomic<bool> done_{false};
  std::thread control_, policy_;
};

}  // namespace

RunResult run_realtime(const ProcessConfig& config, Policy* policy, const CommandSource& command,
                       const RunPlan& plan, bool keep_record, const std::atomic<bool>& interrupt,
                       const std::function<void(const RunSample&)>& progress, const TickTap& tap,
                       const RealtimeHooks& hooks) {
  RealtimeSetup setup(config.realtime);
  sim::Simulator simulator(config.robot, config.simulator);
  if (!plan.start_walking) simulator.reset_lying();
  RunScript script(command, plan, policy != nullptr);
  RunObserver observer(config, simulator, policy ? policy->spec().name : "", keep_record, progress);

  const auto exchange = std::make_unique<PolicyExchange>();
  const auto ring = std::make_unique<TickRing>();
  std::atomic<bool> end{false};
  ControlThread control(simulator, config.controller,
                        plan.start_walking ? Mode::kWalk : Mode::kPassive,
                        hooks.op ? *hooks.op : script, *exchange, *ring, end);
  std::optional<PolicyThread> policy_thread;
  if (policy) policy_thread.emplace(*policy, *exchange);

  const auto drain = [&] {
    while (const TickRecord* tick = ring->front()) {
      observer.add(*tick);
      if (tap) tap(*tick);
      ring->pop();
    }
  };
  RunResult result;
  {
    Threads threads(control, policy_thread ? &*policy_thread : nullptr, hooks, end);
    threads.set_up(setup);
    threads.start();
    while (!threads.done()) {
      std::this_thread::sleep_for(kDrainEvery);
      if (interrupt.load(std::memory_order_relaxed)) end = true;
      drain();
      if (hooks.meanwhile && policy_thread) hooks.meanwhile(*policy_thread);
    }
  }
  drain();

  take_outcome(script, result);
  if (hooks.op) {  // the script had no part in it
    const GateState& gate = control.controller().state().gate;
    result.interrupted = interrupt.load();
    result.survived = gate.first_fault == Fault::kNone;  // also if somebody has reset it since
    if (!result.survived) result.fall_reason = fault_name(gate.first_fault);
    result.walked_s = observer.walked_s();
  }
  result.simulated_s = static_cast<double>(simulator.state().tick) * kControlPeriod_s;
  result.realtime_factor = 1.0;
  StateHash hash;
  simulator.add_to(hash);
  hash.add(control.controller().state());
  if (policy) hash.add(policy->state());
  result.state_hash = hash.value();
  result.figures = observer.figures();
  if (keep_record) result.record = observer.take_record();
  RealtimeReport& report = result.realtime.emplace();
  report.control = control.deadlines();
  if (policy_thread) report.policy = policy_thread->deadlines();
  report.late_policy_outputs = control.controller().state().late_policy_outputs;
  report.records_dropped = ring->dropped();
  report.setup = setup.items();
  return result;
}

}  // namespace sandrunner
