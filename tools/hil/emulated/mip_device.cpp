// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/mip_device.h"

#include <algorithm>

namespace sandrunner::mip {

namespace {

bool offered(std::uint8_t field) {
  return field == kAccel || field == kGyro || field == kQuaternion || field == kReferenceTime;
}

}  // namespace

std::vector<std::uint8_t> Device::receive(Bytes bytes) {
  std::vector<std::uint8_t> replies;
  parser_.feed(bytes, 0, [this, &replies](const PacketView& packet) {
    Bytes payload = packet.payload;
    for (Field command; take_field(payload, command);) {
      std::optional<Packet> response;
      const std::uint8_t code = obey(packet.descriptor_set, command, response);
      const Packet reply =
          response ? *response : acknowledge(packet.descriptor_set, command.descriptor, code);
      replies.insert(replies.end(), reply.bytes().begin(), reply.bytes().end());
    }
  });
  return replies;
}

std::uint8_t Device::obey(std::uint8_t descriptor_set, const Field& command,
                          std::optional<Packet>& response) {
  const Bytes data = command.data;
  const auto is = [&](std::uint8_t set, std::uint8_t descriptor) {
    return descriptor_set == set && command.descriptor == descriptor;
  };
  if (is(kBaseCommands, kPing)) return kAckOk;
  if (is(kBaseCommands, kSetIdle)) return idle_ = true, kAckOk;
  if (is(kBaseCommands, kResume)) return idle_ = false, kAckOk;
  if (is(kBaseCommands, kUartSpeed)) {
    if (data.size() != 6 || data[0] != kApply || data[1] != 1) return kNackParameter;
    baud_ = read_u32(data, 2);
    return kAckOk;
  }
  if (is(k3dmCommands, kBaseRate)) {
    if (data.size() != 1 || data[0] != kSensorData) return kNackParameter;
    response = base_rate_reply(kSensorData, base_rate_hz_);
    return kAckOk;
  }
  if (is(k3dmCommands, kMessageFormat)) return set_format(data);
  if (is(k3dmCommands, kStreamControl)) {
    if (data.size() != 3 || data[0] != kApply || data[1] != kSensorData) return kNackParameter;
    stream_on_ = data[2] != 0;
    return kAckOk;
  }
  return kNackUnknown;
}

std::uint8_t Device::set_format(Bytes data) {
  if (data.size() < 3 || data[0] != kApply || data[1] != kSensorData ||
      data.size() != 3 + std::size_t{3} * data[2]) {
    return kNackParameter;
  }
  std::vector<DecimatedField> format;
  for (std::size_t at = 3; at < data.size(); at += 3) {
    format.push_back({data[at], read_u16(data, at + 1)});
    if (!offered(format.back().descriptor) || format.back().decimation == 0) return kNackParameter;
  }
  format_ = format;
  return kAckOk;
}

std::vector<std::uint8_t> Device::tick(const ImuReading& reading) {
  ++ticks_;
  if (!streaming()) return {};
  const auto due = [this](std::uint8_t descriptor) {
    return std::any_of(format_.begin(), format_.end(), [&](const DecimatedField& field) {
      return field.descriptor == descriptor && ticks_ % field.decimation == 0;
    });
  };
  SensorData data = to_mip(reading);
  if (!due(kAccel)) data.accel_g.reset();
  if (!due(kGyro)) data.gyro_radps.reset();
  if (!due(kQuaternion)) data.quaternion_wxyz.reset();
  if (!due(kReferenceTime)) data.reference_time_ns.reset();
  if (data == SensorData{}) return {};
  const Packet packet = encode_sensor_data(data);
  return {packet.bytes().begin(), packet.bytes().end()};
}

}  // namespace sandrunner::mip
