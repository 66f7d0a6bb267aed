// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/policy_thread.h"

#include "rt/core/slot_grid.h"
#include "rt/loop/lockstep.h"
#include "rt/realtime/clock.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000'000 / kPolicyHz;
// The control tick that releases the input is done by then, mostly.
constexpr std::int64_t kFirstLook_ns = 60'000;

}  // namespace

PolicyThread::PolicyThread(Policy& policy, PolicyExchange& exchange)
    : policy_(policy), exchange_(exchange) {}

void PolicyThread::run(std::int64_t start_ns, const LoopHooks& hooks) noexcept {
  SlotGrid grid(start_ns, kPeriod_ns);
  if (hooks.entered) hooks.entered();
  while (!stop_.load(std::memory_order_relaxed)) {
    sleep_until(grid.due_ns());
    grid.take(monotonic_ns());
    policy_.touch_weights();  // into the caches while the sensors are being read
    const std::int64_t slot_ns = grid.due_ns() - kPeriod_ns;
    for (std::int64_t look = kFirstLook_ns; look < kPeriod_ns; look *= 2) {
      sleep_until(slot_ns + look);
      if (stop_.load(std::memory_order_relaxed)) break;
      if (stalled_.load(std::memory_order_relaxed)) continue;
      if (answer(slot_ns)) break;
    }
  }
  if (hooks.left) hooks.left();
}

bool PolicyThread::answer(std::int64_t slot_ns) noexcept {
  const PolicyInput& input = exchange_.input.read();
  const std::uint64_t sequence = exchange_.input.sequence();
  if (sequence == seen_) return false;
  PolicyDeadlines& d = deadlines_;
  d.missed += sequence - seen_ - 1;
  seen_ = sequence;
  const std::int64_t begin = monotonic_ns();
  step_policy(policy_, input, newest_);
  exchange_.output.write(newest_);
  const std::int64_t end = monotonic_ns();
  ++d.steps;
  d.step.add(end - begin);
  d.answer.add(end - slot_ns);
  return true;
}

}  // namespace sandrunner
