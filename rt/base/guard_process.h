// SPDX-License-Identifier: BSD-3-Clause
// Processes that outlive a controller, to leave its drives safe.
#pragma once

#include <sys/types.h>

namespace sandrunner {

/// Makes a forked child, which has one thread, a process that survives what ends its parent: a name
/// and a command line of its own (rename_process), a session of its own, and no signal that asks
/// for an end. SIGKILL to the process itself or to its control group ends it.
void become_guard(const char* name) noexcept;

/// A pidfd; below 0: there is no such process.
int open_process(pid_t pid) noexcept;

/// Whether the process of a pidfd has not ended.
bool process_runs(int process) noexcept;

}  // namespace sandrunner
