// SPDX-License-Identifier: BSD-3-Clause
// MIP, the protocol of MicroStrain's inertial sensors, as pure functions: both directions of the
// packets that a robot needs, and a parser of the byte stream. No clock, file or heap.
//
// Packet: 75 65, descriptor set, payload length, fields, two checksum bytes. Field: its length with
// these two bytes, descriptor, data. Numbers are big-endian.
//
// Source: 3DM-CV7 user manual, "MIP packet", "Commands", "Data" (files.microstrain.com/CV7+Online);
// descriptors and layouts as in mip_sdk v4, https://github.com/LORD-MicroStrain/mip_sdk.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/imu/big_endian.h"
#include "drivers/imu/frame_parser.h"

namespace sandrunner::mip {

inline constexpr std::uint8_t kSync1 = 0x75, kSync2 = 0x65;
inline constexpr std::size_t kHeaderSize = 4, kChecksumSize = 2;
inline constexpr std::size_t kMaxPayload = 255;
inline constexpr std::size_t kMaxPacket = kHeaderSize + kMaxPayload + kChecksumSize;

/// Descriptor sets: which kind of fields a packet holds.
inline constexpr std::uint8_t kBaseCommands = 0x01, k3dmCommands = 0x0C;
inline constexpr std::uint8_t kSensorData = 0x80, kFilterData = 0x82;

/// Fields of kBaseCommands.
inline constexpr std::uint8_t kPing = 0x01, kSetIdle = 0x02, kResume = 0x06, kUartSpeed = 0x09;
/// Fields of k3dmCommands.
inline constexpr std::uint8_t kBaseRate = 0x0E, kMessageFormat = 0x0F, kStreamControl = 0x11;
/// First byte of a setting: use the new one.
inline constexpr std::uint8_t kApply = 0x01;
/// Fields of replies: what each command is answered with, and what kBaseRate brings besides.
inline constexpr std::uint8_t kAck = 0xF1, kBaseRateReply = 0x8E;
/// Fields of kSensorData.
inline constexpr std::uint8_t kAccel = 0x04, kGyro = 0x05, kQuaternion = 0x0A,
                              kReferenceTime = 0xD5;

/// Codes of kAck; others exist.
inline constexpr std::uint8_t kAckOk = 0, kNackUnknown = 1, kNackParameter = 3;

/// What an acknowledgement's code means.
const char* ack_text(std::uint8_t code) noexcept;

/// Fletcher's checksum of the whole packet before it, in the order in which it is sent.
std::array<std::uint8_t, kChecksumSize> checksum(Bytes bytes) noexcept;

struct Field {
  std::uint8_t descriptor = 0;
  Bytes data;
};

/// Takes the first field off the payload. False: none is left, or, where `payload` is then not
/// empty, its length byte does not fit, so that nothing behind it can be read either.
bool take_field(Bytes& payload, Field& field) noexcept;

/// A packet to be sent. Its bytes are complete after every call.
class Packet {
 public:
  explicit Packet(std::uint8_t descriptor_set) noexcept;

  /// False where the payload has no room left for it: the packet is then as it was.
  bool add(std::uint8_t descriptor, Bytes data) noexcept;

  Bytes bytes() const noexcept { return {bytes_.data(), size_}; }
  std::uint8_t descriptor_set() const noexcept { return bytes_[2]; }
  Bytes payload() const noexcept { return {bytes_.data() + kHeaderSize, bytes_[3]}; }

 private:
  void seal() noexcept;

  std::array<std::uint8_t, kMaxPacket> bytes_{};
  std::size_t size_ = 0;
};

// Commands, each in a packet of its own.
Packet ping() noexcept;
/// Ends all streams until `resume`; the device answers commands faster.
Packet set_idle() noexcept;
Packet resume() noexcept;
/// Asks the rate that decimations of `data_set` divide.
Packet ask_base_rate(std::uint8_t data_set) noexcept;
struct DecimatedField {
  std::uint8_t descriptor = 0;
  std::uint16_t decimation = 1;  ///< base rate / wanted rate
};
/// What packets of `data_set` hold, in this order. At most 83 fields; further ones are left out.
Packet message_format(std::uint8_t data_set, std::span<const DecimatedField> fields) noexcept;
Packet stream_control(std::uint8_t data_set, bool on) noexcept;
/// `port`: 1 is the main one. The device changes its speed within 250 ms and should be left alone
/// for that time.
Packet uart_speed(std::uint8_t port, std::uint32_t baud) noexcept;

// Replies: a command is answered by a packet of its descriptor set.
Packet acknowledge(std::uint8_t command_set, std::uint8_t command, std::uint8_t code) noexcept;
/// `rate_hz` 0: the device has no fixed one.
Packet base_rate_reply(std::uint8_t data_set, std::uint16_t rate_hz) noexcept;

struct Reply {
  std::uint8_t code = 0;  ///< kAckOk, or why not
  Field response;         ///< the field behind the acknowledgement; descriptor 0: none
};
/// The answer to `command` in the payload of a reply; nothing where there is none.
std::optional<Reply> find_reply(Bytes payload, std::uint8_t command) noexcept;

/// A packet of kSensorData. All in the sensor's own axes: x forward, y right, z down (FRD).
struct SensorData {
  std::optional<std::array<float, 3>> accel_g;  ///< specific force, 1 g = 9.80665 m/s^2
  std::optional<std::array<float, 3>> gyro_radps;
  /// Attitude q = (w, x, y, z) by the device's filter: p_sensor = q^-1 p_ned q.
  std::optional<std::array<float, 4>> quaternion_wxyz;
  std::optional<std::uint64_t> reference_time_ns;  ///< device's clock when the sample was taken
  std::uint32_t unknown_fields = 0;                ///< skipped
  std::uint32_t wrong_length_fields = 0;           ///< skipped too
  bool operator==(const SensorData&) const = default;
};
SensorData decode_sensor_data(Bytes payload) noexcept;
/// The counts are not sent.
Packet encode_sensor_data(const SensorData& data) noexcept;

/// A packet that the parser found; valid during the call it is handed to.
struct PacketView {
  std::uint8_t descriptor_set = 0;
  Bytes payload;
  std::int64_t first_byte_ns = 0;  ///< the time that came with the packet's first byte
};

/// How packets look, for the parser (frame_parser.h).
struct Framing {
  static constexpr std::uint8_t kFirstByte = kSync1;
  static constexpr std::size_t kMaxSize = kMaxPacket;
  static std::size_t size(Bytes begun) noexcept;
  static bool intact(Bytes packet) noexcept;
  static PacketView view(Bytes packet, std::int64_t first_byte_ns) noexcept;
};
using Parser = FrameParser<Framing>;

}  // namespace sandrunner::mip
