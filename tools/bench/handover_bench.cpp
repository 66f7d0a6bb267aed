// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "rt/core/log_histogram.h"
#include "rt/core/slot_grid.h"
#include "rt/realtime/clock.h"
#include "rt/realtime/control_thread.h"
#include "rt/realtime/setup.h"
#include "tools/bench/realtime_bench.h"

namespace sandrunner::bench {
namespace {

constexpr int kTicks = 2 * kControlHz;
constexpr auto kDrainEvery = std::chrono::milliseconds(5);

struct Durations {
  LogHistogram handover, clock;
};

// A thread on the grid of the control thread hands over ticks of a robot (not a simulated one, of
// which more is recorded), an ordinary one takes and copies them.
Durations time_handovers() {
  const auto ring = std::make_unique<TickRing>();
  std::atomic<bool> end{false};
  Durations durations;
  std::thread writer([&] {
    prepare_this_thread();
    ControllerInput sensed, input;
    ControllerOutput computed, output;
    SlotGrid grid(monotonic_ns() + kControlPeriod_ns, kControlPeriod_ns);
    for (int i = 0; i < kTicks; ++i) {
      sleep_until(grid.due_ns());
      grid.take(monotonic_ns());
      // As in the control loop, what is handed over was written a moment ago.
      sensed.sensors.tick = static_cast<std::uint64_t>(i);
      input = sensed;
      output = computed;
      asm volatile("" : : "g"(&input), "g"(&output) : "memory");
      const std::int64_t before = monotonic_ns();
      const std::int64_t begin = monotonic_ns();
      if (TickRecord* const record = ring->claim()) {
        record->input = input;
        record->output = output;
        record->counts = record->skipped = record->has_truth = 0;
        record->counters = {};
        record->timing = {};
        ring->publish();
      }
      const std::int64_t after = monotonic_ns();
      durations.clock.add(begin - before);
      durations.handover.add(after - begin);
    }
    end = true;
  });
  std::vector<TickRecord> taken;
  while (!end) {
    std::this_thread::sleep_for(kDrainEvery);
    taken.clear();
    while (const TickRecord* tick = ring->front()) {
      taken.push_back(*tick);
      ring->pop();
    }
    asm volatile("" : : "g"(taken.data()) : "memory");
  }
  writer.join();
  return durations;
}

}  // namespace

void run_handover_bench(int rounds, Report& report) {
  std::vector<double> p50, p99, clock;
  for (int round = 0; round < rounds; ++round) {
    const Durations d = time_handovers();
    p50.push_back(static_cast<double>(d.handover.quantile_ns(0.5)));
    p99.push_back(static_cast<double>(d.handover.quantile_ns(0.99)));
    clock.push_back(static_cast<double>(d.clock.quantile_ns(0.5)));
  }
  report.facts.emplace_back(
      "hand-over",
      "a tick of a robot into the ring to telemetry and recording, from a 4 kHz thread, taken and "
      "copied every 5 ms by another; with one reading of the clock, given for itself too");
  report.rates.emplace_back("tick_handover_p50_ns", quartiles(p50));
  report.rates.emplace_back("tick_handover_p99_ns", quartiles(p99));
  report.rates.emplace_back("clock_p50_ns", quartiles(clock));
}

}  // namespace sandrunner::bench
