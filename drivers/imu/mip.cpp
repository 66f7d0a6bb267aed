// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/mip.h"

#include <algorithm>

namespace sandrunner::mip {

namespace {

using Writer = BigEndianWriter<kMaxPayload>;

Packet command(std::uint8_t descriptor_set, std::uint8_t descriptor, Bytes data = {}) noexcept {
  Packet packet(descriptor_set);
  packet.add(descriptor, data);
  return packet;
}

/// Length of the data of a field of kSensorData; 0: not one that is decoded.
std::size_t sensor_field_length(std::uint8_t descriptor) noexcept {
  switch (descriptor) {
    case kAccel:
    case kGyro:
      return 12;
    case kQuaternion:
      return 16;
    case kReferenceTime:
      return 8;
    default:
      return 0;
  }
}

}  // namespace

const char* ack_text(std::uint8_t code) noexcept {
  switch (code) {
    case kAckOk:
      return "done";
    case kNackUnknown:
      return "it does not know this command";
    case 2:
      return "it found a bad checksum";
    case kNackParameter:
      return "it does not support such a value";
    case 4:
      return "it could not do it";
    case 5:
      return "it took too long";
    default:
      return "it gives a reason that the manual does not name";
  }
}

std::array<std::uint8_t, kChecksumSize> checksum(Bytes bytes) noexcept {
  std::uint8_t a = 0, b = 0;
  for (const std::uint8_t byte : bytes) {
    a = static_cast<std::uint8_t>(a + byte);
    b = static_cast<std::uint8_t>(b + a);
  }
  return {a, b};
}

bool take_field(Bytes& payload, Field& field) noexcept {
  if (payload.size() < 2) return false;
  const std::size_t length = payload[0];
  if (length < 2 || length > payload.size()) return false;
  field = {payload[1], payload.subspan(2, length - 2)};
  payload = payload.subspan(length);
  return true;
}

Packet::Packet(std::uint8_t descriptor_set) noexcept {
  bytes_[0] = kSync1;
  bytes_[1] = kSync2;
  bytes_[2] = descriptor_set;
  seal();
}

bool Packet::add(std::uint8_t descriptor, Bytes data) noexcept {
  const std::size_t length = 2 + data.size(), used = bytes_[3];
  if (used + length > kMaxPayload) return false;
  const auto place = bytes_.begin() + static_cast<std::ptrdiff_t>(kHeaderSize + used);
  place[0] = static_cast<std::uint8_t>(length);
  place[1] = descriptor;
  std::copy(data.begin(), data.end(), place + 2);
  bytes_[3] = static_cast<std::uint8_t>(used + length);
  seal();
  return true;
}

void Packet::seal() noexcept {
  const std::size_t end = kHeaderSize + bytes_[3];
  const auto sum = checksum({bytes_.data(), end});
  bytes_[end] = sum[0];
  bytes_[end + 1] = sum[1];
  size_ = end + kChecksumSize;
}

Packet ping() noexcept { return command(kBaseCommands, kPing); }
Packet set_idle() noexcept { return command(kBaseCommands, kSetIdle); }
Packet resume() noexcept { return command(kBaseCommands, kResume); }

Packet ask_base_rate(std::uint8_t data_set) noexcept {
  return command(k3dmCommands, kBaseRate, Writer().put(data_set).data());
}

Packet message_format(std::uint8_t data_set, std::span<const DecimatedField> fields) noexcept {
  constexpr std::size_t kMostFields = (kMaxPayload - 2 - 3) / 3;
  fields = fields.first(std::min(fields.size(), kMostFields));
  Writer data;
  data.put(kApply).put(data_set).put(static_cast<std::uint8_t>(fields.size()));
  for (const DecimatedField& field : fields) data.put(field.descriptor).put(field.decimation);
  return command(k3dmCommands, kMessageFormat, data.data());
}

Packet stream_control(std::uint8_t data_set, bool on) noexcept {
  return command(k3dmCommands, kStreamControl,
                 Writer().put(kApply).put(data_set).put(std::uint8_t{on}).data());
}

Packet uart_speed(std::uint8_t port, std::uint32_t baud) noexcept {
  return command(kBaseCommands, kUartSpeed, Writer().put(kApply).put(port).put(baud).data());
}

Packet acknowledge(std::uint8_t command_set, std::uint8_t command_field,
                   std::uint8_t code) noexcept {
  return command(command_set, kAck, Writer().put(command_field).put(code).data());
}

Packet base_rate_reply(std::uint8_t data_set, std::uint16_t rate_hz) noexcept {
  Packet packet = acknowledge(k3dmCommands, kBaseRate, kAckOk);
  packet.add(kBaseRateReply, Writer().put(data_set).put(rate_hz).data());
  return packet;
}

std::optional<Reply> find_reply(Bytes payload, std::uint8_t command_field) noexcept {
  Field field;
  while (take_field(payload, field)) {
    if (field.descriptor != kAck || field.data.size() != 2 || field.data[0] != command_field) {
      continue;
    }
    Reply reply{.code = field.data[1], .response = {}};
    if (take_field(payload, field) && field.descriptor != kAck) reply.response = field;
    return reply;
  }
  return std::nullopt;
}

SensorData decode_sensor_data(Bytes payload) noexcept {
  SensorData data;
  Field field;
  while (take_field(payload, field)) {
    const std::size_t length = sensor_field_length(field.descriptor);
    if (length == 0) {
      ++data.unknown_fields;
      continue;
    }
    if (field.data.size() != length) {
      ++data.wrong_length_fields;
      continue;
    }
    switch (field.descriptor) {
      case kAccel:
        data.accel_g = read_floats<3>(field.data);
        break;
      case kGyro:
        data.gyro_radps = read_floats<3>(field.data);
        break;
      case kQuaternion:
        data.quaternion_wxyz = read_floats<4>(field.data);
        break;
      default:
        data.reference_time_ns = read_u64(field.data, 0);
    }
  }
  if (!payload.empty()) ++data.wrong_length_fields;
  return data;
}

Packet encode_sensor_data(const SensorData& data) noexcept {
  Packet packet(kSensorData);
  if (data.accel_g) packet.add(kAccel, Writer().put(*data.accel_g).data());
  if (data.gyro_radps) packet.add(kGyro, Writer().put(*data.gyro_radps).data());
  if (data.quaternion_wxyz) packet.add(kQuaternion, Writer().put(*data.quaternion_wxyz).data());
  if (data.reference_time_ns) {
    packet.add(kReferenceTime, Writer().put(*data.reference_time_ns).data());
  }
  return packet;
}

std::size_t Framing::size(Bytes begun) noexcept {
  if (begun[0] != kSync1 || (begun.size() > 1 && begun[1] != kSync2)) return 0;
  return begun.size() < kHeaderSize ? kHeaderSize : kHeaderSize + begun[3] + kChecksumSize;
}

bool Framing::intact(Bytes packet) noexcept {
  const Bytes sent = packet.last(kChecksumSize);
  const auto sum = checksum(packet.first(packet.size() - kChecksumSize));
  return sum[0] == sent[0] && sum[1] == sent[1];
}

PacketView Framing::view(Bytes packet, std::int64_t first_byte_ns) noexcept {
  return {packet[2], packet.subspan(kHeaderSize, packet[3]), first_byte_ns};
}

}  // namespace sandrunner::mip
