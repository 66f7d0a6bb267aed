// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/rt_report.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>

#include "rt/core/gate_config.h"
#include "rt/core/log_histogram.h"
#include "rt/core/messages.h"
#include "rt/core/slot_grid.h"
#include "rt/realtime/clock.h"
#include "rt/realtime/setup.h"

namespace sandrunner {
namespace {

constexpr int kSample_s = 10;

/// First line of a file of the kernel's; empty without one.
std::string line_of(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

void row(const std::string& name, const std::string& value, const std::string& advice) {
  fmt::print("  {:<26}{}\n", name, value);
  if (!advice.empty()) fmt::print("  {:<26}-> {}\n", "", advice);
}

void print_kernel() {
  utsname name;
  uname(&name);
  const std::string version = name.version;
  const bool full =
      line_of("/sys/kernel/realtime") == "1" || version.find("PREEMPT_RT") != std::string::npos;
  row("kernel", fmt::format("{} {}", name.release, version), "");
  if (full) {
    row("preemption", "PREEMPT_RT", "");
  } else {
    row("preemption",
        version.find("PREEMPT") != std::string::npos ? "some (no PREEMPT_RT)" : "none named",
        "a kernel with PREEMPT_RT (Debian: linux-image-rt-amd64 or -arm64) bounds what a driver "
        "can delay");
  }
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.rfind("flags", 0) != 0) continue;
    if (line.find(" hypervisor") != std::string::npos) {
      row("machine", "virtual",
          "its host stops it now and then for a millisecond and more: nothing in it can help");
    }
    break;
  }
}

void print_processors() {
  const std::vector<int> cpus = allowed_cpus();
  row("processors", fmt::format("{} for this process: {}", cpus.size(), fmt::join(cpus, ", ")),
      cpus.size() < 2 ? "with one, control and policy share it" : "");
  const std::string governor = line_of("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (governor.empty()) {
    row("frequency governor", "none visible", "");
  } else {
    row("frequency governor", governor,
        governor == "performance" ? "" : "cpupower frequency-set -g performance");
  }
  const std::string idle = line_of("/sys/devices/system/cpu/cpuidle/current_driver");
  row("idle driver", idle.empty() ? "none" : idle,
      idle.empty() || idle == "none" ? "" : "sandrunner holds /dev/cpu_dma_latency at 0 if it may");
  const std::string isolated = line_of("/sys/devices/system/cpu/isolated");
  row("isolated", isolated.empty() ? "no processor" : isolated,
      isolated.empty() ? "kernel command line: isolcpus=N nohz_full=N rcu_nocbs=N for the control "
                         "thread's (realtime.control_cpu=N)"
                       : "");
}

void print_limits() {
  const auto limit = [](rlim_t value) {
    return value == RLIM_INFINITY ? std::string("unlimited") : std::to_string(value);
  };
  rlimit rtprio, memlock;
  getrlimit(RLIMIT_RTPRIO, &rtprio);
  getrlimit(RLIMIT_MEMLOCK, &memlock);
  row("limit rtprio", limit(rtprio.rlim_cur), "");
  row("limit memlock",
      limit(memlock.rlim_cur) + (memlock.rlim_cur == RLIM_INFINITY ? "" : " bytes"), "");
  const std::string runtime = line_of("/proc/sys/kernel/sched_rt_runtime_us");
  const std::string period = line_of("/proc/sys/kernel/sched_rt_period_us");
  row("FIFO throttling", runtime == "-1" ? "off" : fmt::format("{} of {} us", runtime, period),
      runtime == "-1" ? "" : "only matters to a thread that never sleeps; ours do");
}

void print_sample() {
  RealtimeConfig config;
  RealtimeSetup setup(config);
  LogHistogram late;
  std::uint64_t skipped = 0, longest = 0;
  std::atomic<bool> go{false};
  std::thread thread([&] {
    prepare_this_thread();
    go.wait(false);
    SlotGrid grid(monotonic_ns() + 1'000'000, kControlPeriod_ns);
    for (std::uint64_t slots = 0; slots < std::uint64_t{kSample_s} * kControlHz; ++slots) {
      sleep_until(grid.due_ns());
      const SlotGrid::Slot slot = grid.take(monotonic_ns());
      late.add(slot.late_ns);
      skipped += slot.skipped;
      slots += slot.skipped;
      longest = std::max(longest, slot.skipped);
    }
  });
  setup.adopt_control_thread(thread.native_handle());
  go = true;
  go.notify_all();
  thread.join();
  fmt::print("\nA thread that wakes every 0.25 ms, {} s:\n", kSample_s);
  for (const SetupItem& item : setup.items()) {
    row(item.name, (item.obtained ? "" : "NOT OBTAINED: ") + item.detail, "");
  }
  const auto us = [](std::uint64_t ns) { return 1e-3 * static_cast<double>(ns); };
  row("starts late by",
      fmt::format("p50 {:.1f} us, p99 {:.1f} us, p99.9 {:.0f} us, at most {:.0f} us",
                  us(late.quantile_ns(0.5)), us(late.quantile_ns(0.99)),
                  us(late.quantile_ns(0.999)), us(late.max_ns())),
      "");
  row("missed",
      fmt::format("{} of {} slots, at most {} in a row", skipped, kSample_s * kControlHz, longest),
      longest > GateConfig{}.stall_fault_ticks
          ? "so many in a row end a run (loop_stalled, controller.gate.stall_fault_ticks): "
            "this machine is for simulation"
      : skipped > 0 ? "counted and bridged by the drives' own last command"
                    : "");
}

}  // namespace

void print_rt_report() {
  fmt::print("What this machine allows a real-time process:\n");
  print_kernel();
  print_processors();
  print_limits();
  std::fflush(stdout);
  print_sample();
}

}  // namespace sandrunner
