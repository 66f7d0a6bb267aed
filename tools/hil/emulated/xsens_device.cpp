// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/xsens_device.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace sandrunner::xsens {

namespace {

constexpr std::string_view kProduct = "MTi-630-8A1G6       ";

bool offered(std::uint16_t id) {
  return id == kSampleTime || id == kQuaternionNwu || id == kAcceleration || id == kRateOfTurn;
}

Message error(std::uint8_t code) { return Message(kError, std::array<std::uint8_t, 1>{code}); }

}  // namespace

std::vector<std::uint8_t> Device::receive(Bytes bytes) {
  std::vector<std::uint8_t> answers;
  parser_.feed(bytes, 0, [this, &answers](const MessageView& message) {
    const Message reply = answer(message.id, message.data);
    answers.insert(answers.end(), reply.bytes().begin(), reply.bytes().end());
  });
  return answers;
}

Message Device::answer(std::uint8_t id, Bytes data) {
  if (id == kGoToConfig) {
    measuring_ = false;
    return Message(kGoToConfig + 1);
  }
  if (measuring_) return error(kInvalidMessage);
  if (id == kGoToMeasurement) {
    measuring_ = true;
    return Message(kGoToMeasurement + 1);
  }
  if (id == kProductCode) {
    const std::vector<std::uint8_t> text(kProduct.begin(), kProduct.end());
    return Message(kProductCode + 1, text);
  }
  return id == kOutputs ? set(data) : error(kInvalidMessage);
}

Message Device::set(Bytes data) {
  std::vector<Output> outputs;
  for (std::size_t i = 0; i < data.size() / kOutputSize; ++i) {
    Output output = read_output(data, i);
    if (!offered(output.id) || output.rate_hz == 0) return error(kInvalidParameter);
    if (output.id != kSampleTime) {
      // The greatest rate that it has and that is not above the wanted one.
      const int every = (most_rate_hz_ + output.rate_hz - 1) / output.rate_hz;
      output.rate_hz = static_cast<std::uint16_t>(most_rate_hz_ / every);
    }
    outputs.push_back(output);
  }
  outputs_ = outputs;
  const Message asked = set_outputs(outputs_);
  return Message(kOutputs + 1, asked.data());
}

bool Device::due(std::uint16_t id) const {
  return std::any_of(outputs_.begin(), outputs_.end(), [&](const Output& output) {
    if (output.id != id) return false;
    return output.rate_hz == kEveryMessage || ticks_ % (most_rate_hz_ / output.rate_hz) == 0;
  });
}

std::vector<std::uint8_t> Device::tick(const ImuReading& reading) {
  ++ticks_;
  if (!measuring_) return {};
  SensorData data = to_xsens(reading);
  if (!due(kQuaternionNwu)) data.quaternion_wxyz.reset();
  if (!due(kAcceleration)) data.acceleration_mps2.reset();
  if (!due(kRateOfTurn)) data.rate_of_turn_radps.reset();
  if (!data.quaternion_wxyz && !data.acceleration_mps2 && !data.rate_of_turn_radps) return {};
  if (!due(kSampleTime)) data.sample_time.reset();
  const Message message = encode_sensor_data(data);
  return {message.bytes().begin(), message.bytes().end()};
}

}  // namespace sandrunner::xsens
