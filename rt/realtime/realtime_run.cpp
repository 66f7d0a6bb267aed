// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/realtime_run.h"

#include <fmt/format.h>
#include <pthread.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "rt/base/standard_error.h"
#include "rt/realtime/watchdog.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kLeadTime_ns = 20'000'000;  // from the last set-up to slot 0
constexpr std::int64_t kGiveUp_ns = 2'000'000'000;
constexpr auto kDrainEvery = std::chrono::milliseconds(5);

// The real-time threads, held until they are set up, and joined in whatever way the run ends: the
// robot is let down first.
class Threads {
 public:
  Threads(ControlThread& control, PolicyThread* policy, Watchdog& watchdog, Clock& clock,
          std::atomic<bool>& end)
      : policy_loop_(policy), watchdog_loop_(watchdog), clock_(clock), end_(end) {
    control_ = std::thread([this, &control] {
      prepare_this_thread();
      start_.wait(0);
      if (start_ > 0) control.run(start_);
      done_ = true;
    });
    pthread_setname_np(control_.native_handle(), "control");
    watchdog_ = std::thread([this] {
      prepare_this_thread();
      start_.wait(0);
      if (start_ > 0) watchdog_loop_.run(start_);
    });
    if (!policy) return;
    policy_ = std::thread([this, policy] {
      prepare_this_thread();
      start_.wait(0);
      if (start_ > 0) policy->run(start_);
    });
  }
  ~Threads() {
    end_ = true;
    std::int64_t unset = 0;
    if (start_.compare_exchange_strong(unset, -1)) start_.notify_all();
    control_.join();
    watchdog_loop_.stop();
    watchdog_.join();
    if (policy_loop_) policy_loop_->stop();
    if (policy_.joinable()) policy_.join();
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  void set_up(RealtimeSetup& setup) {
    setup.adopt_control_thread(control_.native_handle());
    if (policy_.joinable()) setup.adopt_policy_thread(policy_.native_handle());
    setup.adopt_watchdog_thread(watchdog_.native_handle());
  }
  void start() {
    start_ = clock_.now_ns() + kLeadTime_ns;
    start_.notify_all();
  }
  bool done() const noexcept { return done_; }

 private:
  PolicyThread* policy_loop_;
  Watchdog& watchdog_loop_;
  Clock& clock_;
  std::atomic<bool>& end_;
  std::atomic<std::int64_t> start_{0};  // time of slot 0; -1: do not start
  std::atomic<bool> done_{false};
  std::thread control_, policy_, watchdog_;
};

// A control thread that hangs cannot be joined. Its drives are off; what is left is to say so.
void end_if_it_hangs(const Watchdog& watchdog, const std::atomic<std::uint64_t>& ticks,
                     std::uint64_t& ticks_seen, std::int64_t& alive_ns, std::int64_t now_ns) {
  const std::uint64_t now_ticks = ticks.load(std::memory_order_relaxed);
  if (!watchdog.has_cut() || now_ticks != ticks_seen) alive_ns = now_ns;
  ticks_seen = now_ticks;
  if (now_ns - alive_ns < kGiveUp_ns) return;
  to_standard_error("sandrunner: the control thread hangs; its drives are cut; the process ends\n");
  std::_Exit(kExitFailed);
}

RealtimeEnd run_threads(const Rig& rig, const RealtimeConfig& realtime, Clock& clock) {
  RealtimeSetup setup(realtime);
  const auto exchange = std::make_unique<PolicyExchange>();
  const auto ring = std::make_unique<TickRing>();
  std::atomic<bool> stop{false};
  ControlLoop loop(rig.robot, rig.controller, rig.start, *exchange, clock);
  ControlThread control(rig.robot, loop, rig.op, *ring, clock, rig.interrupts, stop);
  Watchdog watchdog(rig.robot, control.ticks(), clock);
  std::optional<PolicyThread> policy_thread;
  rig.policy.reset();
  if (!rig.policy.is_none()) policy_thread.emplace(rig.policy, *exchange, clock);

  RealtimeEnd end;
  // At most what the ring holds, or a sink slower than the ticks would never return.
  const auto drain = [&] {
    for (std::size_t n = 0; n < kTickRingSize; ++n) {
      const TickRecord* tick = ring->front();
      if (!tick) return;
      for (TickSink* sink : rig.sinks) sink->add(*tick);
      ring->pop();
    }
  };
  {
    Threads threads(control, policy_thread ? &*policy_thread : nullptr, watchdog, clock, stop);
    threads.set_up(setup);
    const std::string missing = missing_rights(setup.items());
    if (!missing.empty()) to_standard_error(fmt::format("sandrunner: {}\n", missing));
    const std::int64_t start_ns = clock_ns(CLOCK_REALTIME) + kLeadTime_ns;
    threads.start();
    for (TickSink* sink : rig.sinks) sink->begin(start_ns);
    std::uint64_t ticks_seen = 0;
    std::int64_t alive_ns = clock.now_ns();
    while (!threads.done()) {
      std::this_thread::sleep_for(kDrainEvery);
      drain();
      end_if_it_hangs(watchdog, control.ticks(), ticks_seen, alive_ns, clock.now_ns());
    }
  }
  drain();

  const ControllerState& state = loop.controller().state();
  end.realtime_factor = 1.0;
  StateHash hash;
  rig.robot.add_to(hash);
  hash.add(state);
  add_to(hash, rig.policy.network());
  end.state_hash = hash.value();
  end.gate = state.gate;
  const ControlDeadlines& done = control.deadlines();
  end.time_s = static_cast<double>(done.ticks + done.skipped) * kControlPeriod_s;
  end.report.control = done;
  if (policy_thread) end.report.policy = policy_thread->deadlines();
  end.report.late_policy_outputs = state.late_policy_outputs;
  end.report.records_dropped = ring->dropped();
  end.report.watchdog_gap_ns = watchdog.longest_gap_ns();
  end.report.setup = setup.items();
  return end;
}

}  // namespace

RealtimeEnd run_realtime(const Rig& rig, const RealtimeConfig& realtime, Clock& clock) {
  RealtimeEnd end = run_threads(rig, realtime, clock);
  // Files are finished when memory and processors are free again.
  for (TickSink* sink : rig.sinks) sink->end();
  return end;
}

}  // namespace sandrunner
