// SPDX-License-Identifier: BSD-3-Clause
#include <pthread.h>
#include <sched.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "rt/core/log_histogram.h"
#include "rt/core/triple_buffer.h"
#include "rt/realtime/clock.h"
#include "rt/realtime/setup.h"
#include "tools/bench/realtime_bench.h"

namespace sandrunner::bench {
namespace {

using Payload = std::array<std::uint64_t, 50>;
constexpr int kReads = 200'000;
constexpr int kReaderPriority = 60, kWriterPriority = 80;

class MutexBox {
 public:
  void write(const Payload& value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    value_ = value;
  }
  Payload read() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return value_;
  }

 private:
  std::mutex mutex_;
  Payload value_{};
};

void settle(int priority, int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  const sched_param parameters{.sched_priority = priority};
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

// 99.9th percentile of a read, ns, while another thread writes without a pause.
template <typename Box>
double read_p999_ns() {
  const std::vector<int> cpus = allowed_cpus();
  const auto box = std::make_unique<Box>();
  std::atomic<bool> end{false};
  std::thread writer([&] {
    settle(kWriterPriority, cpus.front());
    Payload value{};
    while (!end.load(std::memory_order_relaxed)) {
      value.fill(value[0] + 1);
      box->write(value);
    }
  });
  LogHistogram durations;
  std::thread reader([&] {
    settle(kReaderPriority, cpus.back());
    std::uint64_t sum = 0;
    for (int i = 0; i < kReads; ++i) {
      const std::int64_t begin = monotonic_ns();
      const Payload value = box->read();
      durations.add(monotonic_ns() - begin);
      sum += value[0] + value[49];
    }
    asm volatile("" : : "r"(sum));
  });
  reader.join();
  end = true;
  writer.join();
  return static_cast<double>(durations.quantile_ns(0.999));
}

}  // namespace

void run_exchange_bench(int rounds, Report& report) {
  std::vector<double> ratios, ours, theirs;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(read_p999_ns<TripleBuffer<Payload>>());
    theirs.push_back(read_p999_ns<MutexBox>());
    ratios.push_back(ours.back() / theirs.back());
    // The writer never sleeps: away from the limit on real-time processor time.
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  report.facts.emplace_back(
      "exchange",
      "400 bytes, a writer that never rests and 200,000 reads, each SCHED_FIFO "
      "on a processor of its own; 99.9th percentile of a read");
  report.rates.emplace_back("triple_buffer_read_p999_ns", quartiles(ours));
  report.rates.emplace_back("mutex_read_p999_ns", quartiles(theirs));
  report.ratios.emplace_back("triple_buffer_p999_vs_mutex", quartiles(ratios));
}

}  // namespace sandrunner::bench
