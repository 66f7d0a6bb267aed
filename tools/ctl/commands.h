// SPDX-License-Identifier: BSD-3-Clause
// The subcommands. Each joins the domain, does its work and prints to standard output; Ctrl-C and
// SIGTERM are normal ends. All throw InputError, and RefusedError if the robot refused or none
// answered.
#pragma once

#include "tools/ctl/interrupt.h"
#include "tools/ctl/options.h"

namespace sandrunner::ctl {

/// Our identity, if DDS Security is on.
inline constexpr const char* kIdentity = "operator";
/// How long to look for a robot, and how long to wait for its answer.
inline constexpr std::int64_t kFindRobot_ns = 2 * kSecond_ns;
inline constexpr std::int64_t kAnswer_ns = 2 * kSecond_ns;
inline constexpr std::int64_t kSettle_ns = 50 * kMs_ns;
/// Velocity commands: 20 a second.
inline constexpr std::int64_t kCommandPeriod_ns = 50 * kMs_ns;
/// Zeros at the end of a motion: a single one might be lost.
inline constexpr int kZeros = 5;

/// One screen; on a terminal, and without `once`, refreshed until interrupted.
void show_status(const Options& options, Interrupt& interrupt);
/// Sends a velocity, then zeros.
void send_command(const Options& options, Interrupt& interrupt);
/// Sends a mode request and prints the answer.
void request_mode(const Options& options, Interrupt& interrupt);
/// Drives by keyboard (drive.cpp).
void drive_robot(const Options& options, Interrupt& interrupt);

}  // namespace sandrunner::ctl
