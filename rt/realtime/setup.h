// SPDX-License-Identifier: BSD-3-Clause
// What a process has to ask of Linux before it may call itself real-time, and what it got.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/settings.h"

namespace sandrunner {

/// How much a part of the set-up matters: refuse to run without it, say so, or do not even ask.
enum class Need { kRequire, kWarn, kOff };

struct RealtimeConfig {
  Need lock_memory = Need::kWarn;  ///< all pages resident, heap and stacks faulted in beforehand
  Need priority = Need::kWarn;     ///< SCHED_FIFO
  Need affinity = Need::kWarn;     ///< a processor of its own for each of the two threads; none
                                   ///< of the process's others runs on the control thread's
  Need dma_latency = Need::kWarn;  ///< no deep idle states of the processor
  int control_priority = 80;
  int policy_priority = 70;  ///< below the control thread's
  // -1: the last processor that the process may use and the other thread does not have.
  int control_cpu = -1;
  int policy_cpu = -1;
};

/// Reads the table [realtime]. Throws InputError.
RealtimeConfig read_realtime_config(ConfigTree& config);
/// The keys of the table [realtime], for the reference.
std::vector<SettingLine> realtime_settings();

/// One line of the report.
struct SetupItem {
  std::string name;
  bool obtained = false;
  std::string detail;  ///< what was got, or why not and the command that grants it
  std::string grant;   ///< that command; empty: it was got, or there is none
};

/// Sets a process up and keeps what has to stay open. Everything that is wanted but not obtained is
/// in items(); a required one throws InputError.
class RealtimeSetup {
 public:
  /// Locks memory, fits the heap, holds the processors awake, and keeps all threads of the process
  /// off the control thread's processor, if there is another, until the destructor; threads that
  /// they start later stay off it too.
  explicit RealtimeSetup(const RealtimeConfig& config);
  ~RealtimeSetup();
  RealtimeSetup(const RealtimeSetup&) = delete;
  RealtimeSetup& operator=(const RealtimeSetup&) = delete;

  /// SCHED_FIFO and processor of the two threads, before they are let into their loops.
  void adopt_control_thread(pthread_t thread);
  void adopt_policy_thread(pthread_t thread);
  /// Above both; where the other threads are.
  void adopt_watchdog_thread(pthread_t thread);

  const std::vector<SetupItem>& items() const noexcept { return items_; }

 private:
  void note(Need need, const std::string& name, int error, const std::string& got,
            const std::string& grant);
  void adopt(pthread_t thread, const std::string& name, int priority);
  void pin(pthread_t thread, const std::string& name, int cpu);
  void keep_others_off_control_cpu();

  RealtimeConfig config_;
  std::vector<SetupItem> items_;
  std::vector<std::pair<pid_t, cpu_set_t>> moved_;  // threads, and the processors that they had
  int dma_latency_ = -1;                            // file descriptor
  bool locked_ = false;
};

/// One line that says which of the wanted rights were not obtained, and the commands that grant
/// them; empty if none is missing.
std::string missing_rights(const std::vector<SetupItem>& items);

/// Touches the stack of the calling thread so far down that its loop finds it present, and flushes
/// denormals. Each real-time thread calls it first.
void prepare_this_thread() noexcept;

/// Processors that this process may use, ascending.
std::vector<int> allowed_cpus();

}  // namespace sandrunner
