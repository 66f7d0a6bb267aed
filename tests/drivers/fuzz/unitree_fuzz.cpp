// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer on a Unitree robot's messages: any state is refused, or read as finite numbers that are
// sent as the same numbers again; any joint command becomes a message that a robot may follow.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "drivers/unitree/messages.h"
#include "tests/drivers/fuzz/fuzz_frame.h"

namespace sandrunner::unitree {
namespace {

void fuzz_state(const std::uint8_t* bytes, std::size_t size) {
  LowState message;
  std::memset(&message, 0, sizeof message);
  std::memcpy(&message, bytes, std::min(size, sizeof message));
  (void)judge_crc(message);
  RobotState state, again;
  if (!decode(message, state)) return;
  require(all_finite(state.position_rad) && all_finite(state.velocity_radps));
  require(all_finite(state.torque_nm) && all_finite(state.orientation_wxyz));
  require(all_finite(state.angular_velocity_radps) && all_finite(state.linear_acceleration_mps2));
  LowState sent;
  encode_state(state, sent);
  require(judge_crc(sent) == Crc::kGood && decode(sent, again));
  require(again.position_rad == state.position_rad && again.lost == state.lost);
  require(again.velocity_radps == state.velocity_radps && again.torque_nm == state.torque_nm);
  require(again.orientation_wxyz == state.orientation_wxyz && again.tick_ms == state.tick_ms);
  require(again.remote.stop == state.remote.stop);
}

void fuzz_command(const std::uint8_t* bytes, std::size_t size, std::uint8_t mode) {
  JointCommand joints;
  std::uint64_t blind = 0;
  std::memcpy(&joints, bytes, std::min(size, sizeof joints));
  if (size > sizeof joints) {
    std::memcpy(&blind, bytes + sizeof joints, std::min(size - sizeof joints, sizeof blind));
  }
  LowCmd command;
  const bool sent = encode_joints(mode, joints, blind, command);
  require(command_mistake(command, mode) == nullptr);
  for (int j = 0; j < kNumJoints; ++j) {
    const unitree_go_msg_dds__MotorCmd_& motor = command.motor_cmd[motor_of(j)];
    require(motor.mode == (sent ? mode : kMotorOff));
    const bool silent = !sent || (blind >> j & 1) != 0;
    require(motor.kp == (silent ? 0.0F : static_cast<float>(joints.kp_nmprad[j])));
  }
  LowCmd any;
  std::memset(&any, 0, sizeof any);
  std::memcpy(&any, bytes, std::min(size, sizeof any));
  (void)command_mistake(any, mode);
}

}  // namespace
}  // namespace sandrunner::unitree

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  if ((data[0] & 1) != 0) {
    sandrunner::unitree::fuzz_state(data + 1, size - 1);
  } else {
    sandrunner::unitree::fuzz_command(data + 1, size - 1, (data[0] & 2) != 0 ? 0x0A : 0x01);
  }
  return 0;
}
