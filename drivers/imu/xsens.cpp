// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/xsens.h"

#include <algorithm>
#include <numeric>

namespace sandrunner::xsens {

namespace {

constexpr std::size_t kHeaderSize = 4, kExtendedHeaderSize = 6, kChecksumSize = 1;
constexpr std::size_t kLeastExtended = 255;
constexpr std::size_t kFieldHeaderSize = 3;  // identifier, size of the data

std::uint8_t sum(Bytes bytes) noexcept {
  return std::accumulate(bytes.begin(), bytes.end(), std::uint8_t{0},
                         [](std::uint8_t a, std::uint8_t b) { return std::uint8_t(a + b); });
}

/// Length of the data of a field of kSensorData; 0: not one that is decoded.
std::size_t field_length(std::uint16_t id) noexcept {
  switch (id) {
    case kSampleTime:
      return 4;
    case kQuaternionNwu:
      return 16;
    case kAcceleration:
    case kRateOfTurn:
      return 12;
    default:
      return 0;
  }
}

}  // namespace

const char* error_text(std::uint8_t code) noexcept {
  switch (code) {
    case 0x03:
      return "the period is not within its range";
    case kInvalidMessage:
      return "it does not know this message";
    case 0x1E:
      return "its timer overflowed";
    case 0x20:
      return "the baud rate is not within its range";
    case kInvalidParameter:
      return "it does not support such a value";
    case 0x28:
      return "it has a fault of its own";
    case 0x29:
      return "its line is too slow for what it is to send";
    default:
      return "it gives a reason that is not documented";
  }
}

Message::Message(std::uint8_t id, Bytes data) noexcept {
  data = data.first(std::min(data.size(), kMaxData));
  bytes_[0] = kPreamble;
  bytes_[1] = kBus;
  bytes_[2] = id;
  if (data.size() < kLeastExtended) {
    bytes_[3] = static_cast<std::uint8_t>(data.size());
  } else {
    bytes_[3] = kExtendedLength;
    bytes_[4] = static_cast<std::uint8_t>(data.size() >> 8);
    bytes_[5] = static_cast<std::uint8_t>(data.size());
    header_size_ = kExtendedHeaderSize;
  }
  std::copy(data.begin(), data.end(), bytes_.data() + header_size_);
  size_ = header_size_ + data.size() + kChecksumSize;
  bytes_[size_ - 1] = static_cast<std::uint8_t>(-sum({bytes_.data() + 1, size_ - 2}));
}

Message set_outputs(std::span<const Output> outputs) noexcept {
  BigEndianWriter<kOutputSize * kMostOutputs> data;
  for (const Output& output : outputs.first(std::min(outputs.size(), kMostOutputs))) {
    data.put(output.id).put(output.rate_hz);
  }
  return Message(kOutputs, data.data());
}

Output read_output(Bytes data, std::size_t index) noexcept {
  return {.id = read_u16(data, kOutputSize * index),
          .rate_hz = read_u16(data, kOutputSize * index + 2)};
}

SensorData decode_sensor_data(Bytes data) noexcept {
  SensorData result;
  while (data.size() >= kFieldHeaderSize && data.size() >= kFieldHeaderSize + data[2]) {
    const std::uint16_t id = read_u16(data, 0);
    const Bytes field = data.subspan(kFieldHeaderSize, data[2]);
    data = data.subspan(kFieldHeaderSize + field.size());
    const std::size_t length = field_length(id);
    if (length == 0) {
      ++result.unknown_fields;
    } else if (field.size() != length) {
      ++result.wrong_length_fields;
    } else if (id == kSampleTime) {
      result.sample_time = read_u32(field, 0);
    } else if (id == kQuaternionNwu) {
      result.quaternion_wxyz = read_floats<4>(field);
    } else if (id == kAcceleration) {
      result.acceleration_mps2 = read_floats<3>(field);
    } else {
      result.rate_of_turn_radps = read_floats<3>(field);
    }
  }
  if (!data.empty()) ++result.wrong_length_fields;
  return result;
}

Message encode_sensor_data(const SensorData& data) noexcept {
  BigEndianWriter<64> out;
  const auto field = [&out](std::uint16_t id, const auto& values) {
    out.put(id).put(static_cast<std::uint8_t>(field_length(id))).put(values);
  };
  if (data.sample_time) field(kSampleTime, *data.sample_time);
  if (data.quaternion_wxyz) field(kQuaternionNwu, *data.quaternion_wxyz);
  if (data.acceleration_mps2) field(kAcceleration, *data.acceleration_mps2);
  if (data.rate_of_turn_radps) field(kRateOfTurn, *data.rate_of_turn_radps);
  return Message(kSensorData, out.data());
}

std::size_t Framing::size(Bytes begun) noexcept {
  if (begun[0] != kPreamble || (begun.size() > 1 && begun[1] != kBus)) return 0;
  if (begun.size() < kHeaderSize) return kHeaderSize;
  if (begun[3] != kExtendedLength) return kHeaderSize + begun[3] + kChecksumSize;
  if (begun.size() < kExtendedHeaderSize) return kExtendedHeaderSize;
  const std::size_t length = read_u16(begun, 4);
  if (length < kLeastExtended || length > kMaxData) return 0;
  return kExtendedHeaderSize + length + kChecksumSize;
}

bool Framing::intact(Bytes message) noexcept { return sum(message.subspan(1)) == 0; }

MessageView Framing::view(Bytes message, std::int64_t first_byte_ns) noexcept {
  const std::size_t header = message[3] == kExtendedLength ? kExtendedHeaderSize : kHeaderSize;
  return {message[2], message.subspan(header, message.size() - header - kChecksumSize),
          first_byte_ns};
}

}  // namespace sandrunner::xsens
