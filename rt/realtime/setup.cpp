// SPDX-License-Identifier: BSD-3-Clause
#include "rt/realtime/setup.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "rt/base/errors.h"
#include "rt/core/processor.h"

namespace sandrunner {
namespace {

constexpr std::size_t kStack_bytes = 256 * 1024;  // far more than a tick uses
constexpr int kHighestPriority = 99;

constexpr const char* kNeeds[] = {"require", "warn", "off"};  // in the order of Need

using C = RealtimeConfig;
constexpr Setting<C> kRealtime[] = {
    {"lock_memory", words<&C::lock_memory>(kNeeds), "Keep all pages of the process in memory."},
    {"priority", words<&C::priority>(kNeeds), "Run the real-time threads under SCHED_FIFO."},
    {"affinity", words<&C::affinity>(kNeeds),
     "Give each real-time thread a processor; no other thread of the process uses the control "
     "thread's."},
    {"dma_latency", words<&C::dma_latency>(kNeeds), "Keep the processors out of deep idle states."},
    {"control_priority", &C::control_priority, 2, 98, "SCHED_FIFO priority of the control thread."},
    {"policy_priority", &C::policy_priority, 1, 97,
     "SCHED_FIFO priority of the policy thread; below the control thread's."},
    {"control_cpu", &C::control_cpu, -1, CPU_SETSIZE - 1,
     "Processor of the control thread; -1: the last one that is free."},
    {"policy_cpu", &C::policy_cpu, -1, CPU_SETSIZE - 1,
     "Processor of the policy thread; -1: the last one that is free."},
};

/// The command that lets this very program lock memory and set priorities.
std::string grant_capabilities() {
  std::error_code unknown;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe", unknown).string();
  return fmt::format("sudo setcap cap_sys_nice,cap_ipc_lock=ep {}",
                     unknown ? "sandrunner" : program);
}

/// The heap keeps what it has once had, and takes it from one piece; or as the C library has it.
void keep_heap(bool keep) {
  mallopt(M_TRIM_THRESHOLD, keep ? -1 : 128 * 1024);
  mallopt(M_MMAP_MAX, keep ? 0 : 65536);
  if (!keep) malloc_trim(0);
}

}  // namespace

RealtimeConfig read_realtime_config(ConfigTree& config) {
  RealtimeConfig c;
  read_settings(config, "realtime", kRealtime, c);
  if (c.policy_priority >= c.control_priority) {
    throw InputError(
        fmt::format("realtime.policy_priority: {}, expected below realtime.control_priority ({})",
                    c.policy_priority, c.control_priority));
  }
  return c;
}

std::vector<SettingLine> realtime_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "realtime", kRealtime);
  return lines;
}

std::vector<int> allowed_cpus() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cpus;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
  }
  return cpus;
}

RealtimeSetup::RealtimeSetup(const RealtimeConfig& config) : config_(config) {
  // The last processor that the other thread does not have; with one only, that one.
  const std::vector<int> cpus = allowed_cpus();
  const auto free_cpu = [&](int taken) {
    for (auto cpu = cpus.rbegin(); cpu != cpus.rend(); ++cpu) {
      if (*cpu != taken) return *cpu;
    }
    return taken;
  };
  if (config_.control_cpu < 0) config_.control_cpu = free_cpu(config_.policy_cpu);
  if (config_.policy_cpu < 0) config_.policy_cpu = free_cpu(config_.control_cpu);
  if (config_.affinity != Need::kOff) keep_others_off_control_cpu();
  if (config_.lock_memory != Need::kOff) {
    keep_heap(true);
    const int error = mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
    locked_ = error == 0;
    note(config_.lock_memory, "memory", error, "all pages locked", grant_capabilities());
  }
  if (config_.dma_latency != Need::kOff) {
    dma_latency_ = open("/dev/cpu_dma_latency", O_RDWR | O_CLOEXEC);
    const std::int32_t none = 0;
    const bool held = dma_latency_ >= 0 && write(dma_latency_, &none, sizeof none) == sizeof none;
    note(config_.dma_latency, "idle states", held ? 0 : errno, "shallow (cpu_dma_latency 0)",
         "sudo setfacl -m u:$USER:rw /dev/cpu_dma_latency");
  }
}

RealtimeSetup::~RealtimeSetup() {
  for (const auto& [thread, cpus] : moved_) sched_setaffinity(thread, sizeof cpus, &cpus);
  if (dma_latency_ >= 0) close(dma_latency_);
  if (locked_) munlockall();
  if (config_.lock_memory != Need::kOff) keep_heap(false);
}

void RealtimeSetup::note(Need need, const std::string& name, int error, const std::string& got,
                         const std::string& grant) {
  if (error == 0) {
    items_.push_back({name, true, got, ""});
    return;
  }
  const std::string why = grant.empty()
                              ? fmt::format("{}: {}", got, std::strerror(error))
                              : fmt::format("{}; to grant it: {}", std::strerror(error), grant);
  if (need == Need::kRequire) {
    throw InputError(fmt::format("realtime: {} is required and was not obtained: {}", name, why));
  }
  items_.push_back({name, false, why, grant});
}

void RealtimeSetup::keep_others_off_control_cpu() {
  std::error_code unreadable;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", unreadable)) {
    const pid_t thread = std::atoi(task.path().filename().c_str());
    cpu_set_t cpus;
    if (sched_getaffinity(thread, sizeof cpus, &cpus) != 0) continue;  // it has ended
    cpu_set_t others = cpus;
    CPU_CLR(config_.control_cpu, &others);
    if (CPU_EQUAL(&others, &cpus) || CPU_COUNT(&others) == 0) continue;
    if (sched_setaffinity(thread, sizeof others, &others) == 0) moved_.emplace_back(thread, cpus);
  }
}

void RealtimeSetup::pin(pthread_t thread, const std::string& name, int cpu) {
  if (config_.affinity == Need::kOff) return;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu < 0 ? 0 : cpu, &set);
  note(config_.affinity, name + " processor", pthread_setaffinity_np(thread, sizeof set, &set),
       fmt::format("CPU {}", cpu), "");
}

void RealtimeSetup::adopt(pthread_t thread, const std::string& name, int priority) {
  if (config_.priority == Need::kOff) return;
  const sched_param parameters{.sched_priority = priority};
  note(config_.priority, name + " priority", pthread_setschedparam(thread, SCHED_FIFO, &parameters),
       fmt::format("SCHED_FIFO {}", priority), grant_capabilities());
}

void RealtimeSetup::adopt_control_thread(pthread_t thread) {
  pin(thread, "control thread", config_.control_cpu);
  adopt(thread, "control thread", config_.control_priority);
}

void RealtimeSetup::adopt_policy_thread(pthread_t thread) {
  pin(thread, "policy thread", config_.policy_cpu);
  adopt(thread, "policy thread", config_.policy_priority);
}

void RealtimeSetup::adopt_watchdog_thread(pthread_t thread) {
  adopt(thread, "watchdog", std::min(config_.control_priority + 1, kHighestPriority));
}

std::string missing_rights(const std::vector<SetupItem>& items) {
  std::string missing;
  std::vector<std::string> grants;
  for (const SetupItem& item : items) {
    if (item.obtained) continue;
    missing += (missing.empty() ? "" : ", ") + item.name;
    const bool known = std::find(grants.begin(), grants.end(), item.grant) != grants.end();
    if (!item.grant.empty() && !known) grants.push_back(item.grant);
  }
  if (missing.empty()) return "";
  return fmt::format("not real-time, not obtained: {}{}{}", missing,
                     grants.empty() ? "" : "; to grant it: ", fmt::join(grants, " && "));
}

void prepare_this_thread() noexcept {
  flush_denormals_to_zero();
  auto* const stack = static_cast<volatile char*>(__builtin_alloca(kStack_bytes));
  for (std::size_t i = 0; i < kStack_bytes; i += 1024) stack[i] = 0;
}

}  // namespace sandrunner
