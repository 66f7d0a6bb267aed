// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <type_traits>

namespace sandrunner::unitree {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the image is the CRC's words as they are");
static_assert(std::is_trivially_copyable_v<LowCmd> && std::is_trivially_copyable_v<LowState>);

constexpr std::uint8_t kHead[] = {0xFE, 0xEF};
constexpr std::uint8_t kLowLevel = 0xFF;

// Keys of the remote: bit 5 of byte 2, bit 1 of byte 3.
constexpr std::size_t kKeysLow = 2, kKeysHigh = 3;
constexpr unsigned kL2 = 1u << 5, kB = 1u << 1;

template <typename Message>
std::uint32_t crc_of_image(const std::array<std::uint8_t, sizeof(Message)>& image) noexcept {
  std::uint32_t crc = 0xFFFFFFFF;
  for (std::size_t at = 0; at + 4 < image.size(); at += 4) {
    std::uint32_t word;
    std::memcpy(&word, image.data() + at, sizeof word);
    crc ^= word;
    for (int bit = 0; bit < 32; ++bit) crc = crc << 1 ^ ((crc >> 31) != 0 ? 0x04C11DB7 : 0);
  }
  return crc;
}

/// A message's bytes, those of its padding zero. `padding(clear)` calls clear(first, end) for each.
template <typename Message, typename Padding>
std::array<std::uint8_t, sizeof(Message)> image_of(const Message& message,
                                                   const Padding& padding) noexcept {
  std::array<std::uint8_t, sizeof(Message)> image;
  std::memcpy(image.data(), &message, sizeof message);
  padding([&](std::size_t first, std::size_t end) {
    std::fill(image.begin() + static_cast<std::ptrdiff_t>(first),
              image.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{0});
  });
  return image;
}

void begin(LowCmd& out) noexcept {
  std::memset(&out, 0, sizeof out);  // the padding too
  std::copy(std::begin(kHead), std::end(kHead), out.head);
  out.level_flag = kLowLevel;
}

bool fits(double value) noexcept {
  return std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

}  // namespace

std::uint32_t crc_of(const LowCmd& command) noexcept {
  return crc_of_image<LowCmd>(image_of(command, [](const auto& clear) {
    clear(22, 24);
    for (std::size_t motor = 24; motor < 744; motor += 36) clear(motor + 1, motor + 4);
    clear(803, 804);
  }));
}

std::uint32_t crc_of(const LowState& state) noexcept {
  return crc_of_image<LowState>(image_of(state, [](const auto& clear) {
    clear(22, 24);
    clear(77, 80);
    for (std::size_t motor = 80; motor < 1040; motor += 48) {
      clear(motor + 1, motor + 4);
      clear(motor + 33, motor + 36);
    }
    clear(1145, 1148);
    clear(1154, 1156);
  }));
}

void encode_off(LowCmd& out) noexcept {
  begin(out);
  out.crc = crc_of(out);
}

void encode_damping(std::uint8_t motor_mode, const LegJoints<double>& kd_nmsprad,
                    LowCmd& out) noexcept {
  begin(out);
  for (int j = 0; j < kNumJoints; ++j) {
    unitree_go_msg_dds__MotorCmd_& motor = out.motor_cmd[motor_of(j)];
    motor.mode = motor_mode;
    motor.kd = static_cast<float>(kd_nmsprad[j % kJointsPerLeg]);
  }
  out.crc = crc_of(out);
}

bool encode_joints(std::uint8_t motor_mode, const JointCommand& joints, std::uint64_t blind_joints,
                   LowCmd& out) noexcept {
  begin(out);
  for (int j = 0; j < kNumJoints; ++j) {
    const double values[] = {joints.position_rad[j], joints.velocity_radps[j],
                             joints.feedforward_nm[j], joints.kp_nmprad[j], joints.kd_nmsprad[j]};
    if (!std::all_of(std::begin(values), std::end(values), fits)) {
      encode_off(out);
      return false;
    }
    unitree_go_msg_dds__MotorCmd_& motor = out.motor_cmd[motor_of(j)];
    motor.mode = motor_mode;
    if ((blind_joints >> j & 1) != 0) continue;
    motor.q = static_cast<float>(values[0]);
    motor.dq = static_cast<float>(values[1]);
    motor.tau = static_cast<float>(values[2]);
    motor.kp = static_cast<float>(values[3]);
    motor.kd = static_cast<float>(values[4]);
  }
  out.crc = crc_of(out);
  return true;
}

const char* command_mistake(const LowCmd& command, std::uint8_t motor_mode) noexcept {
  if (!std::equal(std::begin(kHead), std::end(kHead), command.head)) return "its head";
  if (command.level_flag != kLowLevel) return "its level";
  if (command.crc != crc_of(command)) return "its CRC";
  if (command.bms_cmd.off != 0) return "it switches the battery off";
  for (int i = 0; i < kMotorSlots; ++i) {
    const unitree_go_msg_dds__MotorCmd_& motor = command.motor_cmd[i];
    if (motor.mode != kMotorOff && (motor.mode != motor_mode || i >= kNumJoints)) return "a mode";
    const float values[] = {motor.q, motor.dq, motor.tau, motor.kp, motor.kd};
    for (const float value : values) {
      if (!std::isfinite(value)) return "a number that is not finite";
    }
  }
  return nullptr;
}

Remote read_remote(const std::array<std::uint8_t, kRemoteBytes>& bytes) noexcept {
  return {.on = std::ranges::any_of(bytes, [](std::uint8_t byte) { return byte != 0; }),
          .stop = (bytes[kKeysLow] & kL2) != 0 && (bytes[kKeysHigh] & kB) != 0};
}

bool decode(const LowState& message, RobotState& state) noexcept {
  bool finite = true;
  const auto number = [&](float value) {
    finite = finite && std::isfinite(value);
    return static_cast<double>(value);
  };
  for (int j = 0; j < kNumJoints; ++j) {
    const unitree_go_msg_dds__MotorState_& motor = message.motor_state[motor_of(j)];
    state.position_rad[j] = number(motor.q);
    state.velocity_radps[j] = number(motor.dq);
    state.torque_nm[j] = number(motor.tau_est);
    state.lost[j] = motor.lost;
    state.temperature_degc[j] = static_cast<std::int8_t>(motor.temperature);
    state.mode[j] = motor.mode;
  }
  const unitree_go_msg_dds__IMUState_& imu = message.imu_state;
  for (int i = 0; i < 4; ++i) state.orientation_wxyz[i] = number(imu.quaternion[i]);
  for (int i = 0; i < 3; ++i) {
    state.angular_velocity_radps[i] = number(imu.gyroscope[i]);
    state.linear_acceleration_mps2[i] = number(imu.accelerometer[i]);
  }
  state.tick_ms = message.tick;
  state.battery_percent = message.bms_state.soc;
  state.supply_v = number(message.power_v);
  state.supply_a = number(message.power_a);
  state.remote = read_remote(std::to_array(message.wireless_remote));
  return finite;
}

Crc judge_crc(const LowState& message) noexcept {
  if (message.crc == crc_of(message)) return Crc::kGood;
  return message.crc == 0 ? Crc::kAbsent : Crc::kBad;
}

void encode_state(const RobotState& state, LowState& out) noexcept {
  std::memset(&out, 0, sizeof out);
  std::copy(std::begin(kHead), std::end(kHead), out.head);
  out.level_flag = kLowLevel;
  for (int j = 0; j < kNumJoints; ++j) {
    unitree_go_msg_dds__MotorState_& motor = out.motor_state[motor_of(j)];
    motor.mode = state.mode[j];
    motor.q = motor.q_raw = static_cast<float>(state.position_rad[j]);
    motor.dq = motor.dq_raw = static_cast<float>(state.velocity_radps[j]);
    motor.tau_est = static_cast<float>(state.torque_nm[j]);
    motor.lost = static_cast<std::uint32_t>(state.lost[j]);
    motor.temperature = static_cast<std::uint8_t>(state.temperature_degc[j]);
  }
  unitree_go_msg_dds__IMUState_& imu = out.imu_state;
  for (int i = 0; i < 4; ++i) imu.quaternion[i] = static_cast<float>(state.orientation_wxyz[i]);
  for (int i = 0; i < 3; ++i) {
    imu.gyroscope[i] = static_cast<float>(state.angular_velocity_radps[i]);
    imu.accelerometer[i] = static_cast<float>(state.linear_acceleration_mps2[i]);
  }
  out.tick = state.tick_ms;
  out.bms_state.soc = state.battery_percent;
  out.power_v = static_cast<float>(state.supply_v);
  out.power_a = static_cast<float>(state.supply_a);
  if (state.remote.on) out.wireless_remote[0] = 0x55;  // as a remote at rest has it
  if (state.remote.stop) {
    out.wireless_remote[kKeysLow] = kL2;
    out.wireless_remote[kKeysHigh] = kB;
  }
  out.crc = crc_of(out);
}

}  // namespace sandrunner::unitree
