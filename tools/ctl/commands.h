// SPDX-License-Identifier: BSD-3-Clause
// The subcommands. Each joins the domain, does its work and prints to standard output; the end by
// Ctrl-C or SIGTERM is a normal one. All throw InputError, and RefusedError if the robot refused or
// none answered.
#pragma once

#include "tools/ctl/interrupt.h"
#include "tools/ctl/options.h"

namespace sandrunner::ctl {

/// Whom we are to the robot, with security.
inline constexpr const char* kIdentity = "operator";
/// How long a robot is looked for, and its answer waited for.
inline constexpr std::int64_t kFindRobot_ns = 2 * kSecond_ns;
inline constexpr std::int64_t kAnswer_ns = 2 * kSecond_ns;
inline constexpr std::int64_t kSettle_ns = 50 * kMs_ns;
/// Velocity commands: 20 a second.
inline constexpr std::int64_t kCommandPeriod_ns = 50 * kMs_ns;
/// Zeros at the end of a motion: one may be lost on the way.
inline constexpr int kZeros = 5;

/// One screen; on a terminal, and without `once`, refreshed until interrupted.
void show_status(const Options& options, Interrupt& interrupt);
/// Sends a velocity, then zero.
void send_command(const Options& options, Interrupt& interrupt);
/// Asks for a mode.
void request_mode(const Options& options, Interrupt& interrupt);
/// Prints the messages of a topic.
void watch_topic(const Options& options, Interrupt& interrupt);
/// Drives by keyboard and gamepad (drive.cpp).
void drive_robot(const Options& options, Interrupt& interrupt);

}  // namespace sandrunner::ctl
