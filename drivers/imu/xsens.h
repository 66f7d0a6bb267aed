// SPDX-License-Identifier: BSD-3-Clause
// Xbus, the protocol of Xsens' motion trackers (MTi), as pure functions: both directions of the
// messages that a robot needs, MTData2 among them. No clock, file or heap.
//
// Message: FA, bus FF, identifier, length, data, a checksum byte. A length of FF says that two
// bytes of length follow: 255 to 2048. All bytes behind FA, the checksum too, add up to 0 modulo
// 256. Numbers are big-endian. The answer to a message has its identifier plus one.
//
// Source: MT Low Level Communication Protocol Documentation (MT0101P; mtidocs.movella.com).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/imu/big_endian.h"
#include "drivers/imu/frame_parser.h"

namespace sandrunner::xsens {

inline constexpr std::uint8_t kPreamble = 0xFA, kBus = 0xFF, kExtendedLength = 0xFF;
inline constexpr std::size_t kMaxData = 2048;
inline constexpr std::size_t kMaxMessage = 6 + kMaxData + 1;

/// Identifiers of messages. In the configuration state the device sends no data, and only then
/// takes settings.
inline constexpr std::uint8_t kGoToMeasurement = 0x10, kProductCode = 0x1C, kGoToConfig = 0x30,
                              kSensorData = 0x36, kError = 0x42, kOutputs = 0xC0;

/// Identifiers of what kSensorData holds. Their lowest digit is the format: 0 for single precision,
/// which alone is used here. The quaternion's also names its world: 8 is north, west, up.
inline constexpr std::uint16_t kSampleTime = 0x1060, kQuaternionNwu = 0x2018,
                               kAcceleration = 0x4020, kRateOfTurn = 0x8020;

/// Codes of kError; others exist.
inline constexpr std::uint8_t kInvalidMessage = 0x04, kInvalidParameter = 0x21;
/// What an error's code means.
const char* error_text(std::uint8_t code) noexcept;

/// A message to be sent.
class Message {
 public:
  /// Data beyond kMaxData bytes is left out.
  explicit Message(std::uint8_t id, Bytes data = {}) noexcept;

  std::uint8_t id() const noexcept { return bytes_[2]; }
  Bytes data() const noexcept { return bytes().subspan(header_size_, size_ - header_size_ - 1); }
  Bytes bytes() const noexcept { return {bytes_.data(), size_}; }

 private:
  std::array<std::uint8_t, kMaxMessage> bytes_{};
  std::size_t header_size_ = 4, size_ = 0;
};

/// One entry of kOutputs: what a message of data holds, and how often.
struct Output {
  std::uint16_t id = 0;
  std::uint16_t rate_hz = 0;  ///< kEveryMessage: of kSampleTime
  bool operator==(const Output&) const = default;
};
inline constexpr std::uint16_t kEveryMessage = 0xFFFF;
inline constexpr std::size_t kMostOutputs = 32, kOutputSize = 4;
/// Sets what is sent, in this order; further ones than kMostOutputs are left out. The device keeps
/// it without power. Its answer, kOutputs + 1, holds what it will really send.
Message set_outputs(std::span<const Output> outputs) noexcept;
/// Entry `index` of the data of such a message, which has a quarter as many of them as bytes.
Output read_output(Bytes data, std::size_t index) noexcept;

/// What one message of kSensorData holds. Vectors are in the sensor's axes, which its case shows: x
/// forward, y left, z up (FLU).
struct SensorData {
  std::optional<std::uint32_t> sample_time;  ///< 0.1 ms; begins anew after 4.97 days
  /// Attitude q = (w, x, y, z) by the device's filter: p_nwu = q p_sensor q^-1.
  std::optional<std::array<float, 4>> quaternion_wxyz;
  std::optional<std::array<float, 3>> acceleration_mps2;  ///< specific force: +9.81 in z at rest
  std::optional<std::array<float, 3>> rate_of_turn_radps;
  std::uint32_t unknown_fields = 0;       ///< skipped: also other formats of those above
  std::uint32_t wrong_length_fields = 0;  ///< skipped too
  bool operator==(const SensorData&) const = default;
};
SensorData decode_sensor_data(Bytes data) noexcept;
/// The counts are not sent.
Message encode_sensor_data(const SensorData& data) noexcept;

/// Follows the device's sample time over its end: after 2^32 ticks it begins anew.
class SampleClock {
 public:
  /// Nanoseconds on the device's clock, from an arbitrary beginning. A time that is less than half
  /// a round behind the last one went back: the device was restarted.
  std::uint64_t update(std::uint32_t sample_time) noexcept {
    // As a signed number the difference to the last one is the shorter way round.
    const auto step = static_cast<std::int32_t>(sample_time - static_cast<std::uint32_t>(ticks_));
    ticks_ += started_ ? static_cast<std::uint64_t>(std::int64_t{step}) : sample_time;
    started_ = true;
    return ticks_ * kTick_ns;
  }

  static constexpr std::uint64_t kTick_ns = 100'000;

 private:
  std::uint64_t ticks_ = std::uint64_t{1} << 32;  // so that the first times may go back
  bool started_ = false;
};

/// A message that the parser found; valid during the call it is handed to.
struct MessageView {
  std::uint8_t id = 0;
  Bytes data;
  std::int64_t first_byte_ns = 0;  ///< the time that came with the message's first byte
};

/// How messages look, for the parser (frame_parser.h).
struct Framing {
  static constexpr std::uint8_t kFirstByte = kPreamble;
  static constexpr std::size_t kMaxSize = kMaxMessage;
  static std::size_t size(Bytes begun) noexcept;
  static bool intact(Bytes message) noexcept;
  static MessageView view(Bytes message, std::int64_t first_byte_ns) noexcept;
};
using Parser = FrameParser<Framing>;

}  // namespace sandrunner::xsens
