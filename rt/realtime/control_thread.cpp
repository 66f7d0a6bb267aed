// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/control_thread.h"

#include <algorithm>

#include "rt/core/slot_grid.h"
#include "rt/realtime/clock.h"

namespace sandrunner {

ControlThread::ControlThread(RobotIo& io, const ControllerConfig& config, Mode start,
                             OperatorInput& op, PolicyExchange& exchange, TickRing& ring,
                             const std::atomic<bool>& interrupt)
    : io_(io),
      controller_(config, start),
      operator_(op),
      exchange_(exchange),
      ring_(ring),
      interrupt_(interrupt) {}

void ControlThread::run(std::int64_t start_ns, const LoopHooks& hooks) noexcept {
  constexpr std::int64_t kPeriod_ns = 1'000'000'000 / kControlHz;
  SlotGrid grid(start_ns, kPeriod_ns);
  if (hooks.entered) hooks.entered();
  bool running = true;
  while (running) {
    sleep_until(grid.due_ns());
    const SlotGrid::Slot slot = grid.take(monotonic_ns());
    running = tick(slot.skipped, slot.late_ns);
  }
  io_.shut_down();
  if (hooks.left) hooks.left();
}

bool ControlThread::tick(std::uint64_t skipped, std::int64_t late_ns) noexcept {
  const std::int64_t begin = monotonic_ns();
  ControlDeadlines& d = deadlines_;
  if (skipped > 0) {
    io_.skip(skipped, output_.command);
    d.skipped += skipped;
    d.longest_miss = std::max(d.longest_miss, skipped);
  }
  TickRecord* const claimed = ring_.claim();
  TickRecord& record = claimed ? *claimed : spare_;
  record.has_truth = io_.truth(record.truth) ? 1 : 0;
  record.before = {record.truth.joint_velocity_radps, record.truth.state};

  const std::int64_t before_read = monotonic_ns();
  io_.read(input_.sensors);
  const std::int64_t before_control = monotonic_ns();
  input_.policy = exchange_.output.read();
  input_.command = operator_.command(input_.sensors.tick);
  controller_.step(input_, output_);
  if (output_.release_policy != 0) {
    exchange_.input.write(output_.policy_input);
    ++d.releases;
  }
  const std::int64_t before_write = monotonic_ns();
  io_.write(output_.command);
  const std::int64_t after_write = monotonic_ns();

  TickFacts facts{.ticks = 1 + skipped,
                  .mode = output_.mode,
                  .faults = output_.faults,
                  .first_fault = output_.first_fault,
                  .interrupted = interrupt_.load(std::memory_order_relaxed)};
  if (io_.truth(record.truth)) {
    facts.base_contact = record.truth.base_contact != 0;
    facts.thigh_contact = record.truth.thigh_contact != 0;
  }
  const OperatorVerdict verdict = operator_.advance(facts);

  record.input = input_;
  record.output = output_;
  record.counts = verdict.counts ? 1 : 0;
  record.skipped = skipped;
  record.counters = controller_.state().gate.counters;
  record.timing = {.late_ns = late_ns,
                   .read_ns = before_control - before_read,
                   .control_ns = before_write - before_control,
                   .write_ns = after_write - before_write};
  if (claimed) ring_.publish();

  ++d.ticks;
  d.late.add(record.timing.late_ns);
  d.read.add(record.timing.read_ns);
  d.control.add(record.timing.control_ns);
  d.write.add(record.timing.write_ns);
  d.busy.add(monotonic_ns() - begin);
  return verdict.running;
}

}  // namespace sandrunner
