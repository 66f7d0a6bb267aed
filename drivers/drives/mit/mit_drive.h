// SPDX-License-Identifier: BSD-3-Clause
// Drives of the MIT layout as a family (drive_family.h).
#pragma once

#include "drivers/drives/drive_family.h"
#include "drivers/drives/mit/mit.h"

namespace sandrunner {

/// All but Damiao speak classic CAN alone; read_drive() refuses the others on CAN FD.
CanFormats can_formats(const MitDrive& drive) noexcept;
void set_address(MitDrive& drive, int id, CanFormat format) noexcept;
void read_drive(MitDrive& drive, ConfigTree& table, const std::string& where);
void list_drive_settings(const MitDrive&, std::vector<SettingLine>& lines,
                         const std::string& table);
int drive_id(const MitDrive& drive) noexcept;
std::optional<std::uint32_t> reply_id(const MitDrive& drive) noexcept;
DriveRanges drive_ranges(const MitDrive& drive) noexcept;
/// Damiao's time-out is a register that is not kept.
bool forgets_timeout(const MitDrive& drive) noexcept;
bool hides_timeout(const MitDrive& drive) noexcept;
/// Of a Damiao: its control mode, its ranges and its time-out, which is set first.
std::vector<DriveQuestion> drive_questions(const MitDrive& drive, double timeout_s);

void encode_off(const MitDrive& drive, bool clear_fault, CanFrame& frame) noexcept;
void encode_enable(const MitDrive& drive, const DriveTerms& terms, CanFrame& frame) noexcept;
void encode_command(const MitDrive& drive, const SetPoint& command, const DriveTerms& terms,
                    CanFrame& frame) noexcept;
/// The frame that switches it off: no other has an answer and enables nothing.
void encode_probe(const MitDrive& drive, CanFrame& frame) noexcept;
bool is_probe_reply(const MitDrive& drive, const CanFrame& frame) noexcept;
ReplyKind decode_state(const MitDrive& drive, const CanFrame& frame, DriveState& state) noexcept;
bool is_command_to(const MitDrive& drive, const CanFrame& frame) noexcept;

const char* fault_words(const MitDrive& drive, std::uint8_t code) noexcept;
std::string describe(const MitDrive& drive, const CanFrame& frame);
void encode_example_reply(const MitDrive& drive, const CanFrame& command, CanFrame& frame) noexcept;

static_assert(DriveFamily<MitDrive>);

}  // namespace sandrunner
