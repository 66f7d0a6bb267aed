// SPDX-License-Identifier: BSD-3-Clause
// The interface of a family of motor drives: a type with the address and the settings of one drive,
// and one overload of each function in the concept DriveFamily. Values are at the drive's output,
// in SI units.
//
// README.md shows how to add a family. Examples: mit/mit_drive.h, moteus/moteus_drive.h.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "drivers/can/can_frame.h"
#include "rt/base/config_tree.h"
#include "rt/base/settings.h"

namespace sandrunner {

/// The command of one exchange, of a drive at its output or of its joint. The drive's law:
/// torque = kp (position - q) + kd (velocity - qd) + torque.
struct SetPoint {
  double position_rad = 0.0;
  double velocity_radps = 0.0;
  double kp_nmprad = 0.0;
  double kd_nmsprad = 0.0;
  double torque_nm = 0.0;
};
/// Its numbers as text.
std::string describe(const SetPoint& command);

/// Limits of every command to one drive. A family whose frames lack such a field ignores it.
struct DriveTerms {
  bool torque_only = false;    ///< commands have no gains
  double max_torque_nm = 0.0;  ///< of the whole law
  double timeout_s = 0.0;      ///< without a command for this long the drive gives no torque
};

enum class DrivePower : std::uint8_t { kUnknown, kOff, kOn };

/// The state that a drive reports. NaN: not reported.
struct DriveState {
  double position_rad = 0.0;
  double velocity_radps = 0.0;
  double torque_nm = 0.0;
  double temperature_degc = std::numeric_limits<double>::quiet_NaN();  ///< its hottest
  double voltage_v = std::numeric_limits<double>::quiet_NaN();         ///< of its supply
  std::uint8_t fault = 0;                                              ///< the maker's code
  DrivePower power = DrivePower::kUnknown;
  bool locked = false;  ///< `fault` keeps it off until encode_off() clears it
  bool damps = false;   ///< it timed out, and damps until it is switched off
};

enum class ReplyKind : std::uint8_t {
  kOther,  ///< not of this drive
  kBad,    ///< of this drive, but invalid
  kState,
};

/// The largest values that commands and replies of a drive can express, from minus this to this,
/// gains from 0.
struct DriveRanges {
  double position_rad = 0.0, velocity_radps = 0.0, torque_nm = 0.0;
  double kp_nmprad = 0.0, kd_nmsprad = 0.0;
};

/// The kinds of frames of a family.
struct CanFormats {
  bool classic = false, fd = false;
};

/// A setting that bring-up compares with the drive's own, before the drive is enabled.
struct DriveQuestion {
  std::string what;    ///< "torque range (TMAX)"
  std::string source;  ///< where the drive keeps it: "register 23"
  double expected = 0.0;
  CanFrame request;
  /// The drive's value, if the frame is its answer.
  std::function<std::optional<double>(const CanFrame&)> answer;
};

template <typename Drive>
concept DriveFamily =
    std::is_trivially_copyable_v<Drive> &&
    requires(const Drive& drive, Drive& changed, const CanFrame& received, CanFrame& frame,
             DriveState& state, ConfigTree& table, std::vector<SettingLine>& lines) {
      /// The value of hardware.bus.protocol.
      { Drive::kProtocol } -> std::convertible_to<const char*>;

      // --- configuration; throws InputError ---

      { can_formats(drive) } -> std::same_as<CanFormats>;
      set_address(changed, int{}, CanFormat{});
      /// Reads the family's own keys of a table [[hardware.drive]]; the text names the drive in
      /// errors.
      read_drive(changed, table, std::string{});
      /// Lists these keys for the reference, as keys of the table that the text names.
      list_drive_settings(drive, lines, std::string{});
      { drive_id(drive) } -> std::same_as<int>;
      /// The identifier of its replies, where that is a setting.
      { reply_id(drive) } -> std::same_as<std::optional<std::uint32_t>>;
      { drive_ranges(drive) } -> std::same_as<DriveRanges>;
      /// Whether the drive forgets the time-out of bring-up without its supply.
      { forgets_timeout(drive) } -> std::same_as<bool>;
      /// Whether the drive's time-out can neither be read nor set over CAN.
      { hides_timeout(drive) } -> std::same_as<bool>;
      { drive_questions(drive, double{}) } -> std::same_as<std::vector<DriveQuestion>>;

      // --- frames; real-time safe ---

      /// Switches the drive off. True: clears its fault instead, where that is another frame.
      { encode_off(drive, bool{}, frame) } noexcept;
      { encode_enable(drive, DriveTerms{}, frame) } noexcept;
      { encode_command(drive, SetPoint{}, DriveTerms{}, frame) } noexcept;
      /// Queries the state and enables nothing. Only the address has to be set.
      { encode_probe(drive, frame) } noexcept;
      { is_probe_reply(drive, received) } noexcept -> std::same_as<bool>;
      /// `state` is left as it is unless the result is kState.
      { decode_state(drive, received, state) } noexcept -> std::same_as<ReplyKind>;
      /// Whether this frame is a command of some host to the drive.
      { is_command_to(drive, received) } noexcept -> std::same_as<bool>;

      // --- texts ---

      { fault_words(drive, std::uint8_t{}) } -> std::convertible_to<std::string>;
      /// The meaning of a frame of encode_off, encode_enable or encode_command.
      { describe(drive, received) } -> std::same_as<std::string>;
      /// A reply to `received` of the length that the drive's has.
      { encode_example_reply(drive, received, frame) } noexcept;
    };

}  // namespace sandrunner
