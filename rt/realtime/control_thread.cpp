// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/control_thread.h"

#include <algorithm>

namespace sandrunner {

void ControlThread::run(std::int64_t start_ns) noexcept {
  SlotGrid grid(start_ns, kControlPeriod_ns);
  AfterTick after = AfterTick::kGoOn;
  while (after == AfterTick::kGoOn) {
    clock_.sleep_until(grid.due_ns());
    after = tick(grid.take(clock_.now_ns()));
  }
  robot_.shut_down();
}

AfterTick ControlThread::tick(const SlotGrid::Slot& slot) noexcept {
  const std::int64_t begin = clock_.now_ns();
  TickRecord* const claimed = ring_.claim();
  TickRecord& record = claimed ? *claimed : spare_;
  const int interrupts = std::max<int>(interrupts_.load(std::memory_order_relaxed),
                                       end_.load(std::memory_order_relaxed));
  const AfterTick after = loop_.tick(slot, operator_, interrupts, record);

  ControlDeadlines& d = deadlines_;
  ++d.ticks;
  ticks_.store(d.ticks, std::memory_order_relaxed);
  d.skipped += slot.skipped;
  d.longest_miss = std::max(d.longest_miss, slot.skipped);
  d.releases += record.output.release_policy;
  d.late.add(record.timing.late_ns);
  d.read.add(record.timing.read_ns);
  d.control.add(record.timing.control_ns);
  d.write.add(record.timing.write_ns);
  if (claimed) ring_.publish();
  d.busy.add(clock_.now_ns() - begin);
  return after;
}

}  // namespace sandrunner
