// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu.h"

#include <algorithm>
#include <array>

#include "drivers/imu/deadline.h"
#include "drivers/imu/mip_setup.h"
#include "drivers/imu/xsens_setup.h"
#include "rt/base/clock_ns.h"

namespace sandrunner {

namespace {

constexpr int kFirstSample_ms = 500;
constexpr std::int64_t kLimit_ns = 10'000'000;

const ImuConfig& checked(const ImuConfig& config) {
  check(config);
  return config;
}

}  // namespace

Imu::Imu(const ImuConfig& config)
    : config_(checked(config)),
      port_(config.device, config.baud),
      limit_ns_(std::max(kLimit_ns, std::int64_t{3'000'000'000} / config.quaternion_rate_hz)) {
  if (config.protocol == ImuProtocol::kXsens) parser_.emplace<xsens::Parser>();
  std::visit([this](auto& parser) { set_up(port_, parser, config_); }, parser_);
  const Deadline deadline(kFirstSample_ms);
  while (!poll(clock_ns(CLOCK_MONOTONIC))) {
    if (gone_) refuse_imu(config.device, "was unplugged while it was set up");
    const int left = deadline.left_ms();
    if (left <= 0) refuse_imu(config.device, "acknowledges its settings, but sends no sample");
    port_.wait_readable(left);
  }
}

bool Imu::poll(std::int64_t now_ns) noexcept {
  if (gone_) return false;
  // More than ten times what 3,000,000 baud bring in a control tick; what a stall left behind is
  // read in the next few.
  std::array<std::uint8_t, 1024> bytes;
  const int count = port_.read(bytes);
  if (count < 0) gone_ = true;
  if (count <= 0) return false;
  bytes_ns_ = now_ns;
  counters_.bytes += static_cast<std::uint64_t>(count);
  const std::uint64_t samples = counters_.samples;
  std::visit(
      [&](auto& parser) {
        parser.feed({bytes.data(), static_cast<std::size_t>(count)}, now_ns,
                    [&](const auto& frame) { take(frame, now_ns); });
      },
      parser_);
  return counters_.samples != samples;
}

void Imu::take(const mip::PacketView& packet, std::int64_t now_ns) noexcept {
  if (packet.descriptor_set != mip::kSensorData) {
    ++counters_.other_packets;
    return;
  }
  const mip::SensorData data = mip::decode_sensor_data(packet.payload);
  counters_.wrong_length += data.wrong_length_fields;
  take(to_reading(data), packet.first_byte_ns, now_ns);
}

void Imu::take(const xsens::MessageView& message, std::int64_t now_ns) noexcept {
  if (message.id != xsens::kSensorData) {
    ++counters_.other_packets;
    return;
  }
  const xsens::SensorData data = xsens::decode_sensor_data(message.data);
  counters_.wrong_length += data.wrong_length_fields;
  ImuReading reading = to_reading(data);
  if (data.sample_time) reading.device_ns = xsens_clock_.update(*data.sample_time);
  take(reading, message.first_byte_ns, now_ns);
}

void Imu::take(const ImuReading& reading, std::int64_t first_byte_ns,
               std::int64_t now_ns) noexcept {
  ++counters_.packets;
  if (!reading.device_ns) {
    ++counters_.incomplete;
    return;
  }
  const std::uint64_t device_ns = *reading.device_ns;
  const std::uint64_t last_device_ns = device_ns_;
  device_ns_ = device_ns;
  if (device_ns <= last_device_ns) {
    // Back in time: it was restarted. The next packet counts, with a quaternion of its own.
    if (device_ns < last_device_ns) has_quaternion_ = false;
    ++counters_.repeated;
    repeated_ns_ = now_ns;
    return;
  }
  if (reading.orientation_wxyz) {
    sample_.orientation_wxyz =
        config_.mounting.to_orientation(*reading.orientation_wxyz, sample_.orientation_wxyz);
    quaternion_device_ns_ = device_ns;
    has_quaternion_ = true;
  }
  const bool attitude_is_old =
      !has_quaternion_ || device_ns - quaternion_device_ns_ > static_cast<std::uint64_t>(limit_ns_);
  if (!reading.acceleration_mps2 || !reading.angular_velocity_radps || attitude_is_old) {
    ++counters_.incomplete;
    return;
  }
  sample_.angular_velocity_radps = config_.mounting.to_body(*reading.angular_velocity_radps);
  sample_.linear_acceleration_mps2 = config_.mounting.to_body(*reading.acceleration_mps2);
  sample_time_ns_ = clock_.update(device_ns, first_byte_ns);
  new_ns_ = now_ns;
  ++counters_.samples;
}

Imu::State Imu::state(std::int64_t now_ns) const noexcept {
  if (gone_) return State::kGone;
  if (now_ns - new_ns_ <= limit_ns_) return State::kStreaming;
  if (now_ns - repeated_ns_ <= limit_ns_) return State::kRepeating;
  return now_ns - bytes_ns_ <= limit_ns_ ? State::kGarbage : State::kSilent;
}

Imu::Counters Imu::counters() const noexcept {
  Counters counters = counters_;
  std::visit(
      [&counters](const auto& parser) {
        counters.skipped_bytes = parser.skipped_bytes();
        counters.bad_checksums = parser.bad_checksums();
      },
      parser_);
  counters.clock_restarts = clock_.restarts();
  return counters;
}

const char* to_string(Imu::State state) noexcept {
  switch (state) {
    case Imu::State::kStreaming:
      return "streaming";
    case Imu::State::kSilent:
      return "silent";
    case Imu::State::kRepeating:
      return "repeating one sample";
    case Imu::State::kGarbage:
      return "bytes, but no sample";
    case Imu::State::kGone:
      return "unplugged";
  }
  return "?";
}

}  // namespace sandrunner
