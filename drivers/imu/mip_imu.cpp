// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/mip_imu.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "rt/base/errors.h"

namespace sandrunner {

namespace {

constexpr double kMostLoad = 0.8;
constexpr int kBitsPerByte = 10;  // start bit, 8 data bits, stop bit
constexpr int kQuaternionSize = 18;
constexpr int kPacketSize = 62;  // acceleration, angular rate, quaternion, reference time
constexpr std::uint8_t kMainPort = 1;
constexpr int kReply_ms = 200;        // some ms of device and converter; the machine may be busy
constexpr int kSpeedChange_ms = 250;  // user manual, "Comm Port Speed (0x01,0x09)"
constexpr int kFirstSample_ms = 500;
constexpr std::int64_t kLimit_ns = 10'000'000;

using Deadline = std::chrono::steady_clock::time_point;

Deadline after_ms(int time_ms) {
  return std::chrono::steady_clock::now() + std::chrono::milliseconds(time_ms);
}

int left_ms(Deadline deadline) {
  const auto left = deadline - std::chrono::steady_clock::now();
  return static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count());
}

/// CLOCK_MONOTONIC, as `poll` is given it.
std::int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const MipImuConfig& checked(const MipImuConfig& config) {
  check(config);
  return config;
}

double bits_per_s(int rate_hz, int quaternion_rate_hz) noexcept {
  return kBitsPerByte * (double{kPacketSize - kQuaternionSize} * rate_hz +
                         double{kQuaternionSize} * quaternion_rate_hz);
}

}  // namespace

double mip_line_load(int rate_hz, int quaternion_rate_hz, unsigned baud) noexcept {
  return bits_per_s(rate_hz, quaternion_rate_hz) / baud;
}

void check(const MipImuConfig& config) {
  const int rate = config.rate_hz, quaternion_rate = config.quaternion_rate_hz;
  const auto refuse_config = [&config](const std::string& why) {
    throw InputError(one_line(fmt::format("IMU {}: {}", config.device, why)));
  };
  if (rate < 1 || rate > 1000) {
    refuse_config(fmt::format("a rate of {} Hz is not within 1 to 1000 Hz", rate));
  }
  if (quaternion_rate < 1 || quaternion_rate > rate || rate % quaternion_rate != 0) {
    refuse_config(
        fmt::format("a quaternion rate of {} Hz is not the rate of {} Hz over a whole "
                    "number",
                    quaternion_rate, rate));
  }
  std::vector<unsigned> bauds(kMipBauds.begin(), kMipBauds.end());
  std::sort(bauds.begin(), bauds.end());
  if (std::find(bauds.begin(), bauds.end(), config.baud) == bauds.end()) {
    refuse_config(fmt::format("{} baud is none of {}", config.baud, fmt::join(bauds, ", ")));
  }
  const double load = mip_line_load(rate, quaternion_rate, config.baud);
  if (load > kMostLoad) {
    std::string way_out;
    for (const unsigned baud : bauds) {
      if (mip_line_load(rate, quaternion_rate, baud) > kMostLoad) continue;
      way_out = fmt::format("{} baud is enough, or ", baud);
      break;
    }
    refuse_config(fmt::format(
        "samples at {} Hz with quaternions at {} Hz need {:.0f} bit/s, {:.0f} % of {} baud, and at "
        "most {:.0f} % may be used: {}at most {:.0f} Hz of both",
        rate, quaternion_rate, bits_per_s(rate, quaternion_rate), 100 * load, config.baud,
        100 * kMostLoad, way_out, std::floor(kMostLoad * config.baud / bits_per_s(1, 1))));
  }
}

MipImu::MipImu(const MipImuConfig& config)
    : config_(checked(config)),
      port_(config.device, config.baud),
      limit_ns_(std::max(kLimit_ns, std::int64_t{3'000'000'000} / config.quaternion_rate_hz)) {
  set_up();
}

void MipImu::refuse(const std::string& why) const {
  throw InputError(one_line(fmt::format("IMU {}: {}", port_.device(), why)));
}

void MipImu::set_up() {
  change_speed(find_speed());

  std::array<std::uint8_t, 3> answer{};
  demand(mip::ask_base_rate(mip::kSensorData), "tell its base rate", answer);
  const int base_rate = mip::read_u16(answer, 1);
  if (answer[0] != mip::kSensorData || base_rate == 0) refuse("has no fixed base rate");
  if (base_rate % config_.rate_hz != 0) {
    refuse(fmt::format("a rate of {} Hz is not the device's base rate of {} Hz over a whole number",
                       config_.rate_hz, base_rate));
  }
  const auto every = [base_rate](int rate_hz) {
    return static_cast<std::uint16_t>(base_rate / rate_hz);
  };
  const std::uint16_t n = every(config_.rate_hz);
  const std::array<mip::DecimatedField, 4> fields{
      {{mip::kAccel, n},
       {mip::kGyro, n},
       {mip::kQuaternion, every(config_.quaternion_rate_hz)},
       {mip::kReferenceTime, n}}};
  demand(mip::message_format(mip::kSensorData, fields),
         "send acceleration, angular rate, quaternion and reference time");
  // The filter's own stream would take its part of the line. Sensors without one refuse: as good.
  mip::Reply reply;
  ask(mip::stream_control(mip::kFilterData, false), kReply_ms, reply);
  demand(mip::stream_control(mip::kSensorData, true), "turn its stream on");
  demand(mip::resume(), "resume streaming");

  const Deadline deadline = after_ms(kFirstSample_ms);
  while (!poll(now_ns())) {
    if (gone_) refuse("was unplugged while it was set up");
    const int left = left_ms(deadline);
    if (left <= 0) refuse("acknowledges its settings, but sends no sample");
    port_.wait_readable(left);
  }
}

unsigned MipImu::find_speed() {
  std::vector<unsigned> bauds{config_.baud};
  std::copy_if(kMipBauds.begin(), kMipBauds.end(), std::back_inserter(bauds),
               [this](unsigned baud) { return baud != config_.baud; });
  for (const unsigned baud : bauds) {
    try {
      port_.set_baud(baud);
    } catch (const InputError&) {
      if (baud == config_.baud) throw;
      continue;  // one that only the search wants
    }
    parser_.reset();
    for (int attempt = 0; attempt < 2; ++attempt) {
      mip::Reply reply;
      if (ask(mip::set_idle(), kReply_ms, reply) && reply.code == mip::kAckOk) return baud;
    }
  }
  std::sort(bauds.begin(), bauds.end());
  refuse(fmt::format(
      "no answer at {} baud, {} bytes heard; is it a MicroStrain sensor, powered, RX to TX?",
      fmt::join(bauds, ", "), counters_.bytes));
}

void MipImu::change_speed(unsigned found_baud) {
  if (found_baud == config_.baud) return;
  mip::Reply reply;
  // Its acknowledgement may come at either speed: what counts is an answer at the new one.
  const bool answered = ask(mip::uart_speed(kMainPort, config_.baud), kSpeedChange_ms, reply);
  if (answered && reply.code != mip::kAckOk) {
    refuse(fmt::format("does not take {} baud (it is at {}): {}", config_.baud, found_baud,
                       mip::ack_text(reply.code)));
  }
  // The device is to be left alone for that long; what it still sends is thrown away.
  const Deadline deadline = after_ms(kSpeedChange_ms);
  std::array<std::uint8_t, 1024> ignored;
  for (int left = kSpeedChange_ms; left > 0; left = left_ms(deadline)) {
    if (port_.read(ignored) < 0) refuse("was unplugged while it was set up");
    port_.wait_readable(left);
  }
  port_.set_baud(config_.baud);
  parser_.reset();
  demand(mip::ping(), "answer at its new speed");
}

bool MipImu::ask(const mip::Packet& command, int timeout_ms, mip::Reply& reply,
                 std::span<std::uint8_t> response) {
  port_.write(command.bytes());
  const Deadline deadline = after_ms(timeout_ms);
  bool answered = false;
  const auto look = [&](const mip::PacketView& packet) {
    if (packet.descriptor_set != command.descriptor_set() || answered) return;
    const auto found = mip::find_reply(packet.payload, command.payload()[1]);
    if (!found) return;
    if (found->code == mip::kAckOk && !response.empty()) {
      if (found->response.data.size() != response.size()) return;
      std::copy(found->response.data.begin(), found->response.data.end(), response.begin());
    }
    reply.code = found->code;
    answered = true;
  };
  std::array<std::uint8_t, 1024> bytes;
  for (int left = timeout_ms; !answered && left > 0; left = left_ms(deadline)) {
    const int count = port_.read(bytes);
    if (count < 0) refuse("was unplugged while it was set up");
    counters_.bytes += static_cast<std::uint64_t>(count);
    parser_.feed({bytes.data(), static_cast<std::size_t>(count)}, 0, look);
    if (count == 0) port_.wait_readable(left);
  }
  return answered;
}

void MipImu::demand(const mip::Packet& command, const char* what,
                    std::span<std::uint8_t> response) {
  mip::Reply reply;
  for (int attempt = 0; attempt < 3; ++attempt) {
    parser_.reset();  // an idle device sends nothing that would end a packet with a false length
    if (!ask(command, kReply_ms, reply, response)) continue;
    if (reply.code == mip::kAckOk) return;
    refuse(fmt::format("does not {}: {} (command {:02X} {:02X})", what, mip::ack_text(reply.code),
                       command.descriptor_set(), command.payload()[1]));
  }
  refuse(fmt::format("does not {}: no answer (command {:02X} {:02X})", what,
                     command.descriptor_set(), command.payload()[1]));
}

bool MipImu::poll(std::int64_t now_ns) noexcept {
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
  parser_.feed({bytes.data(), static_cast<std::size_t>(count)}, now_ns,
               [this, now_ns](const mip::PacketView& packet) { take(packet, now_ns); });
  return counters_.samples != samples;
}

void MipImu::take(const mip::PacketView& packet, std::int64_t now_ns) noexcept {
  if (packet.descriptor_set != mip::kSensorData) {
    ++counters_.other_packets;
    return;
  }
  ++counters_.packets;
  const mip::SensorData data = mip::decode_sensor_data(packet.payload);
  if (data.wrong_length_fields > 0) {
    counters_.wrong_length += data.wrong_length_fields;
    counters_.wrong_length_field = data.wrong_length_field;
  }
  if (!data.reference_time_ns) {
    ++counters_.incomplete;
    return;
  }
  const std::uint64_t device_ns = *data.reference_time_ns;
  const std::uint64_t last_device_ns = device_ns_;
  device_ns_ = device_ns;
  if (device_ns <= last_device_ns) {
    // Back in time: it was restarted. The next packet counts, with a quaternion of its own.
    if (device_ns < last_device_ns) has_quaternion_ = false;
    ++counters_.repeated;
    repeated_ns_ = now_ns;
    return;
  }
  if (data.quaternion_wxyz) {
    sample_.orientation_wxyz =
        config_.mounting.to_orientation(*data.quaternion_wxyz, sample_.orientation_wxyz);
    quaternion_device_ns_ = device_ns;
    has_quaternion_ = true;
  }
  const bool attitude_is_old =
      !has_quaternion_ || device_ns - quaternion_device_ns_ > static_cast<std::uint64_t>(limit_ns_);
  if (!data.accel_g || !data.gyro_radps || attitude_is_old) {
    ++counters_.incomplete;
    return;
  }
  sample_.angular_velocity_radps = config_.mounting.to_body(*data.gyro_radps);
  const Vector3 accel_g = config_.mounting.to_body(*data.accel_g);
  for (std::size_t i = 0; i < accel_g.size(); ++i) {
    sample_.linear_acceleration_mps2[i] = accel_g[i] * kStandardGravity_mps2;
  }
  sample_time_ns_ = clock_.update(device_ns, packet.first_byte_ns);
  new_ns_ = now_ns;
  ++counters_.samples;
}

MipImu::State MipImu::state(std::int64_t now_ns) const noexcept {
  if (gone_) return State::kGone;
  if (now_ns - new_ns_ <= limit_ns_) return State::kStreaming;
  if (now_ns - repeated_ns_ <= limit_ns_) return State::kRepeating;
  return now_ns - bytes_ns_ <= limit_ns_ ? State::kGarbage : State::kSilent;
}

MipImu::Counters MipImu::counters() const noexcept {
  Counters counters = counters_;
  counters.skipped_bytes = parser_.skipped_bytes();
  counters.bad_checksums = parser_.bad_checksums();
  counters.clock_restarts = clock_.restarts();
  return counters;
}

const char* to_string(MipImu::State state) noexcept {
  switch (state) {
    case MipImu::State::kStreaming:
      return "streaming";
    case MipImu::State::kSilent:
      return "silent";
    case MipImu::State::kRepeating:
      return "repeating one sample";
    case MipImu::State::kGarbage:
      return "bytes, but no sample";
    case MipImu::State::kGone:
      return "unplugged";
  }
  return "?";
}

}  // namespace sandrunner
