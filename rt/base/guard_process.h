// SPDX-License-Identifier: BSD-3-Clause
// Processes that outlive a controller, to leave its drives safe: how they are forked, what they
// share with it, and what makes them survive.
#pragma once

#include <sys/mman.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <string_view>

namespace sandrunner {

/// Maps memory that forked children share. Throws InputError, which begins with `key`.
void* map_shared(std::size_t size, const char* key);

/// A T that this process shares with those that it forks. T has no destructor of its own to run.
template <typename T>
class Shared {
 public:
  /// Throws InputError, which begins with `key`.
  explicit Shared(const char* key) : value_(new(map_shared(sizeof(T), key)) T) {}
  ~Shared() { munmap(value_, sizeof(T)); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  T& operator*() const noexcept { return *value_; }
  T* operator->() const noexcept { return value_; }

 private:
  T* value_;
};

/// fork(), while this process has one thread. Throws InputError, which begins with `key`.
pid_t fork_process(const char* key);

/// Renames this process: the kernel's name of it, which `pkill NAME` and `killall NAME` compare
/// (its first 15 characters), and its command line, which `pkill -f` and `ps` show. For a forked
/// process that must survive what ends the program it comes from. The program file behind it keeps
/// its name: `pidof` and `fuser` find it still. Overwrites the strings of main()'s argv. To be
/// called while the process has one thread.
void rename_process(const char* name) noexcept;

/// Makes a forked child, which has one thread, a process that survives what ends its parent: a name
/// and a command line of its own (rename_process), a session of its own, and no signal that asks
/// for an end. SIGKILL to the process itself or to its control group ends it.
void become_guard(const char* name) noexcept;

/// Locks this process's memory and gives it this SCHED_FIFO priority. False: it has none.
bool become_real_time(int priority) noexcept;

/// A pidfd; below 0: there is no such process.
int open_process(pid_t pid) noexcept;

/// Whether the process of a pidfd has not ended.
bool process_runs(int process) noexcept;

/// Less than a second.
void pause_ns(std::int64_t time_ns) noexcept;

/// Writes as much of `text` as fits, with a 0 at its end: to shared memory or an array of DDS.
void write_text(std::string_view text, std::span<char> place) noexcept;

}  // namespace sandrunner
