// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/mip_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "drivers/imu/dialogue.h"

namespace sandrunner {

namespace {

constexpr std::uint8_t kMainPort = 1;
constexpr int kSpeedChange_ms = 250;  // user manual, "Comm Port Speed (0x01,0x09)"

using MipDialogue = Dialogue<mip::Parser>;

/// Whether a packet is the answer to `command`; if it is, its code goes to `code`, and what it
/// answers besides to `response`, where that is asked for and as long.
auto answer_to(const mip::Packet& command, std::uint8_t& code,
               std::span<std::uint8_t> response = {}) {
  return [&command, &code, response](const mip::PacketView& packet) {
    if (packet.descriptor_set != command.descriptor_set()) return false;
    const auto found = mip::find_reply(packet.payload, command.payload()[1]);
    if (!found) return false;
    if (found->code == mip::kAckOk && !response.empty()) {
      if (found->response.data.size() != response.size()) return false;
      std::copy(found->response.data.begin(), found->response.data.end(), response.begin());
    }
    code = found->code;
    return true;
  };
}

/// InputError where there is no answer, or a refusal. `what`: what the command was to do.
void demand(MipDialogue& dialogue, const mip::Packet& command, const char* what,
            std::span<std::uint8_t> response = {}) {
  std::uint8_t code = mip::kAckOk;
  const bool answered = dialogue.ask_again(command.bytes(), answer_to(command, code, response));
  if (answered && code == mip::kAckOk) return;
  dialogue.refuse(fmt::format("does not {}: {} (command {:02X} {:02X})", what,
                              answered ? mip::ack_text(code) : "no answer",
                              command.descriptor_set(), command.payload()[1]));
}

void change_speed(MipDialogue& dialogue, unsigned found_baud, unsigned baud) {
  const mip::Packet command = mip::uart_speed(kMainPort, baud);
  std::uint8_t code = mip::kAckOk;
  // Its acknowledgement may come at either speed: what counts is an answer at the new one.
  if (dialogue.ask(command.bytes(), kSpeedChange_ms, answer_to(command, code)) &&
      code != mip::kAckOk) {
    dialogue.refuse(fmt::format("does not take {} baud (it is at {}): {}", baud, found_baud,
                                mip::ack_text(code)));
  }
  dialogue.change_baud(baud, kSpeedChange_ms);  // it needs this long without requests
  demand(dialogue, mip::ping(), "answer at its new speed");
}

}  // namespace

void set_up(SerialPort& port, mip::Parser& parser, const ImuConfig& config) {
  MipDialogue dialogue(port, parser);
  std::uint8_t code = mip::kAckOk;
  const mip::Packet idle = mip::set_idle();
  const unsigned baud = dialogue.find_baud(config, "a MicroStrain", [&] {
    return dialogue.ask(idle.bytes(), MipDialogue::kReply_ms, answer_to(idle, code)) &&
           code == mip::kAckOk;
  });
  if (baud != config.baud) change_speed(dialogue, baud, config.baud);

  std::array<std::uint8_t, 3> answer{};
  demand(dialogue, mip::ask_base_rate(mip::kSensorData), "tell its base rate", answer);
  const int base_rate = read_u16(answer, 1);
  if (answer[0] != mip::kSensorData || base_rate == 0) dialogue.refuse("has no fixed base rate");
  if (base_rate % config.rate_hz != 0) {
    dialogue.refuse(
        fmt::format("a rate of {} Hz is not the device's base rate of {} Hz over a whole number",
                    config.rate_hz, base_rate));
  }
  const auto every = [base_rate](int rate_hz) {
    return static_cast<std::uint16_t>(base_rate / rate_hz);
  };
  const std::uint16_t n = every(config.rate_hz);
  const std::array<mip::DecimatedField, 4> fields{
      {{mip::kAccel, n},
       {mip::kGyro, n},
       {mip::kQuaternion, every(config.quaternion_rate_hz)},
       {mip::kReferenceTime, n}}};
  demand(dialogue, mip::message_format(mip::kSensorData, fields),
         "send acceleration, angular rate, quaternion and reference time");
  // The filter's own stream would take its part of the line. Sensors without one refuse: as good.
  const mip::Packet filter_off = mip::stream_control(mip::kFilterData, false);
  dialogue.ask(filter_off.bytes(), MipDialogue::kReply_ms, answer_to(filter_off, code));
  demand(dialogue, mip::stream_control(mip::kSensorData, true), "turn its stream on");
  demand(dialogue, mip::resume(), "resume streaming");
}

}  // namespace sandrunner
