// SPDX-License-Identifier: BSD-3-Clause
// moteus as a family of drives (drive_family.h).
#pragma once

#include "drivers/drives/drive_family.h"
#include "drivers/drives/moteus/moteus.h"

namespace sandrunner {

CanFormats can_formats(const MoteusDrive& drive) noexcept;
void set_address(MoteusDrive& drive, int id, CanFormat format) noexcept;
void read_drive(MoteusDrive& drive, ConfigTree& table, const std::string& where);
void list_drive_settings(const MoteusDrive&, std::vector<SettingLine>& lines,
                         const std::string& table);
int drive_id(const MoteusDrive& drive) noexcept;
std::optional<std::uint32_t> reply_id(const MoteusDrive& drive) noexcept;
DriveRanges drive_ranges(const MoteusDrive& drive) noexcept;
/// The time-out is in every command.
bool forgets_timeout(const MoteusDrive& drive) noexcept;
bool hides_timeout(const MoteusDrive& drive) noexcept;
std::vector<DriveQuestion> drive_questions(const MoteusDrive& drive, double timeout_s);

/// A stop clears faults too.
void encode_off(const MoteusDrive& drive, bool clear_fault, CanFrame& frame) noexcept;
/// The first command enables it: here one of no torque.
void encode_enable(const MoteusDrive& drive, const DriveTerms& terms, CanFrame& frame) noexcept;
void encode_command(const MoteusDrive& drive, const SetPoint& command, const DriveTerms& terms,
                    CanFrame& frame) noexcept;
void encode_probe(const MoteusDrive& drive, CanFrame& frame) noexcept;
bool is_probe_reply(const MoteusDrive& drive, const CanFrame& frame) noexcept;
ReplyKind decode_state(const MoteusDrive& drive, const CanFrame& frame, DriveState& state) noexcept;
bool is_command_to(const MoteusDrive& drive, const CanFrame& frame) noexcept;

const char* fault_words(const MoteusDrive& drive, std::uint8_t code) noexcept;
std::string describe(const MoteusDrive& drive, const CanFrame& frame);
void encode_example_reply(const MoteusDrive& drive, const CanFrame& command,
                          CanFrame& frame) noexcept;

static_assert(DriveFamily<MoteusDrive>);

}  // namespace sandrunner
