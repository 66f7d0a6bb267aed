// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sandrunner {

/// Renames this process: the kernel's name of it, which `pkill NAME` and `killall NAME` compare
/// (its first 15 characters), and its command line, which `pkill -f` and `ps` show. For a forked
/// process that must survive what ends the program it comes from. The program file behind it keeps
/// its name: `pidof` and `fuser` find it still. Overwrites the strings of main()'s argv. To be
/// called while the process has one thread.
void rename_process(const char* name) noexcept;

}  // namespace sandrunner
