// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/xsens_setup.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "drivers/imu/dialogue.h"

namespace sandrunner {

namespace {

using XsensDialogue = Dialogue<xsens::Parser>;

constexpr int kTextSize = 20;

const char* name_of(std::uint16_t output) {
  switch (output) {
    case xsens::kSampleTime:
      return "its time";
    case xsens::kQuaternionNwu:
      return "quaternions";
    case xsens::kAcceleration:
      return "accelerations";
    default:
      return "angular rates";
  }
}

/// The data of the answer. InputError where there is none, or a refusal. `what`: what the command
/// was to do.
std::vector<std::uint8_t> demand(XsensDialogue& dialogue, const xsens::Message& command,
                                 const std::string& what) {
  std::uint8_t id = 0;
  std::vector<std::uint8_t> data;
  const bool answered = dialogue.ask_again(command.bytes(), [&](const xsens::MessageView& message) {
    if (message.id != command.id() + 1 && message.id != xsens::kError) return false;
    id = message.id;
    data.assign(message.data.begin(), message.data.end());
    return true;
  });
  if (answered && id != xsens::kError) return data;
  dialogue.refuse(fmt::format(
      "does not {}: {} (message {:02X})", what,
      answered ? xsens::error_text(data.empty() ? 0 : data[0]) : "no answer", command.id()));
}

/// "MTi-630-8A1G6": padded with blanks, and nothing of it can be trusted on a terminal.
std::string product_of(const std::vector<std::uint8_t>& data) {
  std::string text;
  for (const std::uint8_t byte : data) {
    if (byte > ' ' && byte < 0x7F && text.size() < kTextSize) text += static_cast<char>(byte);
  }
  return text.empty() ? "the device" : text;
}

void require_granted(const XsensDialogue& dialogue, const std::string& product,
                     std::span<const xsens::Output> asked, Bytes answer) {
  const std::size_t count = answer.size() / 4;
  for (const xsens::Output& output : asked) {
    std::size_t i = 0;
    while (i < count && xsens::read_output(answer, i).id != output.id) ++i;
    if (i == count)
      dialogue.refuse(fmt::format("{} does not send {}", product, name_of(output.id)));
    const int rate_hz = xsens::read_output(answer, i).rate_hz;
    if (output.id == xsens::kSampleTime || rate_hz == output.rate_hz) continue;
    dialogue.refuse(fmt::format("{} sends {} at {} Hz where {} were asked for", product,
                                name_of(output.id), rate_hz, output.rate_hz));
  }
  if (count != asked.size()) {
    dialogue.refuse(
        fmt::format("{} sends {} outputs where {} were asked for", product, count, asked.size()));
  }
}

}  // namespace

void set_up(SerialPort& port, xsens::Parser& parser, const ImuConfig& config) {
  XsensDialogue dialogue(port, parser);
  const xsens::Message to_config(xsens::kGoToConfig);
  const unsigned baud = dialogue.find_baud(config, "an Xsens", [&] {
    return dialogue.ask(
        to_config.bytes(), XsensDialogue::kReply_ms,
        [](const xsens::MessageView& message) { return message.id == xsens::kGoToConfig + 1; });
  });
  const std::string product =
      product_of(demand(dialogue, xsens::Message(xsens::kProductCode), "tell its product code"));
  if (baud != config.baud) {
    dialogue.refuse(fmt::format(
        "{} is at {} baud, configured are {}: set the configuration to that, or the sensor with "
        "Xsens' MT Manager, which it keeps",
        product, baud, config.baud));
  }
  const auto rate = static_cast<std::uint16_t>(config.rate_hz);
  const std::array<xsens::Output, 4> outputs{
      {{xsens::kSampleTime, xsens::kEveryMessage},
       {xsens::kQuaternionNwu, static_cast<std::uint16_t>(config.quaternion_rate_hz)},
       {xsens::kAcceleration, rate},
       {xsens::kRateOfTurn, rate}}};
  require_granted(dialogue, product, outputs,
                  demand(dialogue, xsens::set_outputs(outputs),
                         "send time, quaternion, acceleration and angular rate"));
  demand(dialogue, xsens::Message(xsens::kGoToMeasurement), "measure");
}

}  // namespace sandrunner
