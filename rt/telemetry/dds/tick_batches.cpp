// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/tick_batches.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "rt/telemetry/dds/sandrunner.h"

namespace sandrunner {
namespace {

template <std::size_t kSize>
void copy(float (&to)[kSize], const std::array<double, kSize>& from) {
  for (std::size_t i = 0; i < kSize; ++i) to[i] = static_cast<float>(from[i]);
}

std::uint32_t ns32(std::int64_t duration_ns) {
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(duration_ns, 0, UINT32_MAX));
}

void fill(sandrunner_TickState& s, const TickRecord& tick) {
  const SensorFrame& sensors = tick.input.sensors;
  const JointCommand& sent = tick.output.command.joints();
  s.tick = sensors.tick;
  s.faults = tick.output.faults;
  s.mode = static_cast<std::uint32_t>(tick.output.mode);
  s.skipped = static_cast<std::uint32_t>(std::min<std::uint64_t>(tick.skipped, UINT32_MAX));
  copy(s.position_rad, sensors.joints.position_rad);
  copy(s.velocity_radps, sensors.joints.velocity_radps);
  copy(s.torque_nm, sensors.joints.torque_nm);
  copy(s.target_rad, sent.position_rad);
  copy(s.kp_nmprad, sent.kp_nmprad);
  copy(s.kd_nmsprad, sent.kd_nmsprad);
  copy(s.orientation_wxyz, sensors.imu.orientation_wxyz);
  copy(s.angular_velocity_radps, sensors.imu.angular_velocity_radps);
  copy(s.linear_acceleration_mps2, sensors.imu.linear_acceleration_mps2);
  const VelocityCommand& command = tick.output.policy_input.command;
  copy(s.command, {command.vx_mps, command.vy_mps, command.wz_radps});
  s.command_share = static_cast<float>(tick.output.command_share);
  const PolicyOutput& policy = tick.input.policy;
  s.body_height_m = static_cast<float>(policy.estimate.body_height_m);
  copy(s.body_velocity_mps, policy.estimate.velocity_mps);
  copy(s.foot_height_m, policy.estimate.foot_height_m);
  s.policy_sequence = static_cast<std::uint32_t>(policy.sequence);
  s.late_ns = ns32(tick.timing.late_ns);
  s.read_ns = ns32(tick.timing.read_ns);
  s.control_ns = ns32(tick.timing.control_ns);
  s.write_ns = ns32(tick.timing.write_ns);
}

}  // namespace

struct TickBatches::Batch {
  dds_entity_t writer = 0;
  std::array<sandrunner_TickState, kTicksPerBatch> ticks{};
  sandrunner_TickBatch message{
      .sequence_number = 0, .stamp_ns = 0, .ticks = {kTicksPerBatch, 0, ticks.data(), false}};
};

TickBatches::TickBatches(const DdsParticipant& participant) : batch_(std::make_unique<Batch>()) {
  batch_->writer = participant.writer("sandrunner/ticks", sandrunner_TickBatch_desc, kBatchDepth);
}

TickBatches::~TickBatches() = default;

bool TickBatches::add(const TickRecord& tick, std::int64_t stamp_ns) {
  sandrunner_TickBatch& message = batch_->message;
  if (message.ticks._length == 0) message.stamp_ns = stamp_ns;
  fill(batch_->ticks[message.ticks._length++], tick);
  return message.ticks._length < kTicksPerBatch || flush();
}

bool TickBatches::flush() {
  sandrunner_TickBatch& message = batch_->message;
  if (message.ticks._length == 0) return true;
  ++message.sequence_number;
  const bool written = dds_write(batch_->writer, &message) >= 0;
  message.ticks._length = 0;
  return written;
}

}  // namespace sandrunner
