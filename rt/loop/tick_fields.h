// SPDX-License-Identifier: BSD-3-Clause
// A TickRecord word by word: the one description of its layout, from which a recording's schema is
// made and by which a replay names what differs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Some words of 64 bits in a row.
struct TickField {
  const char* name;
  int words;
  char kind;  ///< 'd' double, 'u' and 'i' integer without and with a sign
};

// In the order of TickRecord, its members and theirs.
inline constexpr std::array kTickFields = {
    // ControllerInput: sensors, policy, command
    TickField{"tick", 1, 'u'}, TickField{"joint_position_rad", 12, 'd'},
    TickField{"joint_velocity_radps", 12, 'd'}, TickField{"joint_torque_nm", 12, 'd'},
    TickField{"joints_tick", 1, 'u'}, TickField{"imu_orientation_wxyz", 4, 'd'},
    TickField{"imu_angular_velocity_radps", 3, 'd'},
    TickField{"imu_linear_acceleration_mps2", 3, 'd'}, TickField{"imu_tick", 1, 'u'},
    TickField{"policy_input_tick", 1, 'u'}, TickField{"policy_episode", 1, 'u'},
    TickField{"policy_sequence", 1, 'u'}, TickField{"policy_target_rad", 12, 'd'},
    TickField{"policy_body_height_m", 1, 'd'}, TickField{"policy_velocity_mps", 3, 'd'},
    TickField{"policy_foot_height_m", 4, 'd'}, TickField{"operator_velocity", 3, 'd'},
    TickField{"operator_request", 1, 'u'}, TickField{"operator_request_id", 1, 'u'},
    TickField{"operator_tick", 1, 'u'},
    // ControllerOutput: command, policy input, state
    TickField{"command_position_rad", 12, 'd'}, TickField{"command_velocity_radps", 12, 'd'},
    TickField{"command_kp_nmprad", 12, 'd'}, TickField{"command_kd_nmsprad", 12, 'd'},
    TickField{"command_feedforward_nm", 12, 'd'}, TickField{"command_enabled", 1, 'u'},
    TickField{"released_tick", 1, 'u'}, TickField{"released_episode", 1, 'u'},
    TickField{"released_command", 3, 'd'}, TickField{"released_joint_position_rad", 12, 'd'},
    TickField{"released_joint_velocity_radps", 12, 'd'},
    TickField{"released_joint_torque_nm", 12, 'd'}, TickField{"released_joints_tick", 1, 'u'},
    TickField{"released_imu_orientation_wxyz", 4, 'd'},
    TickField{"released_imu_angular_velocity_radps", 3, 'd'},
    TickField{"released_imu_linear_acceleration_mps2", 3, 'd'},
    TickField{"released_imu_tick", 1, 'u'}, TickField{"release_policy", 1, 'u'},
    TickField{"mode", 1, 'u'}, TickField{"faults", 1, 'u'},
    // The rest of TickRecord
    TickField{"counts", 1, 'u'}, TickField{"joint_past_stop", 1, 'u'},
    TickField{"joint_too_fast", 1, 'u'}, TickField{"skipped", 1, 'u'}, TickField{"late_ns", 1, 'i'},
    TickField{"read_ns", 1, 'i'}, TickField{"control_ns", 1, 'i'}, TickField{"write_ns", 1, 'i'},
    TickField{"true_joint_velocity_before_radps", 12, 'd'},
    TickField{"true_body_height_before_m", 1, 'd'}, TickField{"true_velocity_before_mps", 3, 'd'},
    TickField{"true_foot_height_before_m", 4, 'd'}, TickField{"true_position_m", 3, 'd'},
    TickField{"true_orientation_wxyz", 4, 'd'}, TickField{"true_joint_position_rad", 12, 'd'},
    TickField{"true_velocity_world_mps", 3, 'd'}, TickField{"true_angular_velocity_radps", 3, 'd'},
    TickField{"true_joint_velocity_radps", 12, 'd'}, TickField{"true_joint_torque_nm", 12, 'd'},
    TickField{"true_body_height_m", 1, 'd'}, TickField{"true_velocity_mps", 3, 'd'},
    TickField{"true_foot_height_m", 4, 'd'}, TickField{"true_foot_centre_m", 12, 'd'},
    TickField{"true_foot_penetration_m", 4, 'd'}};

inline constexpr std::size_t kTickWords = sizeof(TickRecord) / 8;
using TickWords = std::array<std::uint64_t, kTickWords>;
static_assert(sizeof(TickWords) == sizeof(TickRecord));

constexpr std::size_t words_of_tick_fields() {
  std::size_t sum = 0;
  for (const TickField& field : kTickFields) sum += static_cast<std::size_t>(field.words);
  return sum;
}
static_assert(words_of_tick_fields() == kTickWords, "the table and TickRecord go together");
// Where the larger parts begin, so that two mistakes cannot make up for each other.
static_assert(offsetof(TickRecord, output) == sizeof(ControllerInput));
static_assert(sizeof(ControllerInput) == 8 * (1 + 36 + 1 + 10 + 1 + 3 + 12 + 8 + 3 + 3));
static_assert(sizeof(ControllerOutput) == 8 * (60 + 1 + 2 + 3 + 36 + 1 + 10 + 1 + 3));

/// Name of a word: "joint_position_rad[3]", "tick".
std::string tick_word_name(std::size_t word);

/// OMG IDL of one tick and of a batch of them. The classic CDR of a batch, little-endian, is its
/// sequence number and the records' own bytes.
std::string tick_idl();

}  // namespace sandrunner
