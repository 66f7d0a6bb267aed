// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/policy_thread.h"

#include "rt/core/slot_grid.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000'000 / kPolicyHz;
// The control tick that releases the input is done by then, mostly.
constexpr std::int64_t kFirstLook_ns = 60'000;

}  // namespace

void PolicyThread::run(std::int64_t start_ns) noexcept {
  SlotGrid grid(start_ns, kPeriod_ns);
  while (!stop_.load(std::memory_order_relaxed)) {
    clock_.sleep_until(grid.due_ns());
    grid.take(clock_.now_ns());
    policy_.touch_weights();  // into the caches while the sensors are being read
    const std::int64_t slot_ns = grid.due_ns() - kPeriod_ns;
    for (std::int64_t look = kFirstLook_ns; look < kPeriod_ns; look *= 2) {
      clock_.sleep_until(slot_ns + look);
      if (stop_.load(std::memory_order_relaxed)) break;
      if (answer(slot_ns)) break;
    }
  }
}

bool PolicyThread::answer(std::int64_t slot_ns) noexcept {
  const PolicyInput& input = exchange_.input.read();
  const std::uint64_t sequence = exchange_.input.sequence();
  if (sequence == seen_) return false;
  PolicyDeadlines& d = deadlines_;
  d.missed += sequence - seen_ - 1;
  seen_ = sequence;
  const std::int64_t begin = clock_.now_ns();
  policy_.step(input);
  exchange_.output.write(policy_.newest());
  const std::int64_t end = clock_.now_ns();
  ++d.steps;
  d.step.add(end - begin);
  d.answer.add(end - slot_ns);
  return true;
}

}  // namespace sandrunner
