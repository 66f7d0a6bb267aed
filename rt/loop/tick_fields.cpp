// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/tick_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace sandrunner {
namespace {

template <typename T>
struct Element {
  using Type = T;
};
template <typename T, std::size_t kSize>
struct Element<std::array<T, kSize>> : Element<T> {};

template <typename Member>
constexpr TickField field(const char* name, std::size_t offset) {
  using Type = typename Element<Member>::Type;
  static_assert(sizeof(Type) == 8);
  const char kind = std::is_same_v<Type, double> ? 'd' : std::is_signed_v<Type> ? 'i' : 'u';
  return {name, offset / 8, sizeof(Member) / 8, kind};
}

// The compiler finds place, size and kind of a member: a name cannot stand for another's values.
#define FIELD(name, member) field<decltype(TickRecord::member)>(name, offsetof(TickRecord, member))
// SafeCommand keeps its members to itself; it is a JointCommand and one word.
#define COMMAND_FIELD(name, member)      \
  field<decltype(JointCommand::member)>( \
      name, offsetof(TickRecord, output.command) + offsetof(JointCommand, member))

// clang-format off
constexpr std::array kFields = {
    FIELD("tick", input.sensors.tick),
    FIELD("joint_position_rad", input.sensors.joints.position_rad),
    FIELD("joint_velocity_radps", input.sensors.joints.velocity_radps),
    FIELD("joint_torque_nm", input.sensors.joints.torque_nm),
    FIELD("joint_drive_fault", input.sensors.joints.drive_fault),
    FIELD("joint_drive_warning", input.sensors.joints.drive_warning),
    FIELD("joint_tick", input.sensors.joints.tick),
    FIELD("imu_orientation_wxyz", input.sensors.imu.orientation_wxyz),
    FIELD("imu_angular_velocity_radps", input.sensors.imu.angular_velocity_radps),
    FIELD("imu_linear_acceleration_mps2", input.sensors.imu.linear_acceleration_mps2),
    FIELD("imu_tick", input.sensors.imu.tick),
    FIELD("emergency_stop", input.sensors.emergency_stop),
    FIELD("drives_cut", input.sensors.drives_cut),
    FIELD("foreign_traffic", input.sensors.foreign_traffic),
    FIELD("policy_input_tick", input.policy.input_tick),
    FIELD("policy_episode", input.policy.episode),
    FIELD("policy_sequence", input.policy.sequence),
    FIELD("policy_target_rad", input.policy.target_rad),
    FIELD("policy_body_height_m", input.policy.estimate.body_height_m),
    FIELD("policy_velocity_mps", input.policy.estimate.velocity_mps),
    FIELD("policy_foot_height_m", input.policy.estimate.foot_height_m),
    FIELD("operator_vx_mps", input.command.velocity.vx_mps),
    FIELD("operator_vy_mps", input.command.velocity.vy_mps),
    FIELD("operator_wz_radps", input.command.velocity.wz_radps),
    FIELD("operator_request", input.command.request),
    FIELD("operator_request_id", input.command.request_id),
    FIELD("operator_tick", input.command.tick),
    COMMAND_FIELD("command_position_rad", position_rad),
    COMMAND_FIELD("command_velocity_radps", velocity_radps),
    COMMAND_FIELD("command_kp_nmprad", kp_nmprad),
    COMMAND_FIELD("command_kd_nmsprad", kd_nmsprad),
    COMMAND_FIELD("command_feedforward_nm", feedforward_nm),
    field<std::uint64_t>("command_enabled",
                         offsetof(TickRecord, output.command) + sizeof(JointCommand)),
    field<std::uint64_t>("command_blind_joints",
                         offsetof(TickRecord, output.command) + sizeof(JointCommand) + 8),
    FIELD("released_tick", output.policy_input.tick),
    FIELD("released_episode", output.policy_input.episode),
    FIELD("released_vx_mps", output.policy_input.command.vx_mps),
    FIELD("released_vy_mps", output.policy_input.command.vy_mps),
    FIELD("released_wz_radps", output.policy_input.command.wz_radps),
    FIELD("released_joint_position_rad", output.policy_input.joints.position_rad),
    FIELD("released_joint_velocity_radps", output.policy_input.joints.velocity_radps),
    FIELD("released_joint_torque_nm", output.policy_input.joints.torque_nm),
    FIELD("released_joint_drive_fault", output.policy_input.joints.drive_fault),
    FIELD("released_joint_drive_warning", output.policy_input.joints.drive_warning),
    FIELD("released_joint_tick", output.policy_input.joints.tick),
    FIELD("released_imu_orientation_wxyz", output.policy_input.imu.orientation_wxyz),
    FIELD("released_imu_angular_velocity_radps", output.policy_input.imu.angular_velocity_radps),
    FIELD("released_imu_linear_acceleration_mps2",
          output.policy_input.imu.linear_acceleration_mps2),
    FIELD("released_imu_tick", output.policy_input.imu.tick),
    FIELD("release_policy", output.release_policy),
    FIELD("mode", output.mode),
    FIELD("faults", output.faults),
    FIELD("first_fault", output.first_fault),
    FIELD("fault_joints", output.fault_joints),
    FIELD("warnings", output.warnings),
    FIELD("command_share", output.command_share),
    FIELD("ticks_joint_past_stop", counters.joint_past_stop),
    FIELD("ticks_joint_too_fast", counters.joint_too_fast),
    FIELD("ticks_tilted", counters.tilted),
    FIELD("ticks_hot", counters.hot),
    FIELD("ticks_stalled", counters.stalled),
    FIELD("ticks_joints_late", counters.joints_late),
    FIELD("ticks_imu_late", counters.imu_late),
    FIELD("ticks_position_clamped", counters.position_clamped),
    FIELD("ticks_velocity_clamped", counters.velocity_clamped),
    FIELD("ticks_torque_clamped", counters.torque_clamped),
    FIELD("ticks_gains_clamped", counters.gains_clamped),
    FIELD("ticks_power_clamped", counters.power_clamped),
    FIELD("ticks_command_clamped", counters.command_clamped),
    FIELD("counts", counts),
    FIELD("skipped", skipped),
    FIELD("late_ns", timing.late_ns),
    FIELD("read_ns", timing.read_ns),
    FIELD("control_ns", timing.control_ns),
    FIELD("write_ns", timing.write_ns),
    FIELD("has_truth", has_truth),
    FIELD("true_joint_velocity_before_radps", before.joint_velocity_radps),
    FIELD("true_body_height_before_m", before.state.body_height_m),
    FIELD("true_body_velocity_before_mps", before.state.velocity_mps),
    FIELD("true_foot_height_before_m", before.state.foot_height_m),
    FIELD("true_position_m", truth.position_m),
    FIELD("true_orientation_wxyz", truth.orientation_wxyz),
    FIELD("true_velocity_mps", truth.velocity_mps),
    FIELD("true_angular_velocity_radps", truth.angular_velocity_radps),
    FIELD("true_joint_position_rad", truth.joint_position_rad),
    FIELD("true_joint_velocity_radps", truth.joint_velocity_radps),
    FIELD("true_joint_torque_nm", truth.joint_torque_nm),
    FIELD("true_body_height_m", truth.state.body_height_m),
    FIELD("true_body_velocity_mps", truth.state.velocity_mps),
    FIELD("true_foot_height_m", truth.state.foot_height_m),
    FIELD("true_foot_centre_m", truth.foot_centre_m),
    FIELD("true_foot_penetration_m", truth.foot_penetration_m),
    FIELD("true_foot_force_n", truth.foot_force_n),
    FIELD("true_base_contact", truth.base_contact),
    FIELD("true_thigh_contact", truth.thigh_contact)};
// clang-format on
#undef FIELD
#undef COMMAND_FIELD

constexpr bool without_gap() {
  std::size_t word = 0;
  for (const TickField& f : kFields) {
    if (f.first_word != word) return false;
    word += f.words;
  }
  return word == kTickWords;
}
static_assert(without_gap(), "every word of a TickRecord has a name, in its order");

}  // namespace

std::span<const TickField> tick_fields() { return kFields; }

const TickField& tick_field_of(std::size_t word) {
  return *(std::upper_bound(kFields.begin(), kFields.end(), word,
                            [](std::size_t w, const TickField& f) { return w < f.first_word; }) -
           1);
}

std::string tick_word_name(std::size_t word) {
  const TickField& field = tick_field_of(word);
  return field.words == 1 ? field.name : fmt::format("{}[{}]", field.name, word - field.first_word);
}

std::string tick_idl() {
  std::string idl = "module sandrunner {\n  struct TickRecord {\n";
  for (const TickField& field : kFields) {
    const char* const type = field.kind == 'd'   ? "double"
                             : field.kind == 'u' ? "unsigned long long"
                                                 : "long long";
    idl += field.words == 1 ? fmt::format("    {} {};\n", type, field.name)
                            : fmt::format("    {} {}[{}];\n", type, field.name, field.words);
  }
  return idl +
         "  };\n  struct TickRecordBatch {\n    unsigned long long sequence_number;\n"
         "    sequence<TickRecord> ticks;\n  };\n};\n";
}

}  // namespace sandrunner
