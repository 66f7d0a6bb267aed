// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/imu/big_endian.h"
#include "drivers/imu/deadline.h"
#include "drivers/imu/imu_config.h"
#include "drivers/imu/serial_port.h"
#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"

namespace sandrunner {

/// Questions to a device that is being set up, and its answers among whatever else comes. `Parser`:
/// that of its protocol, which keeps what comes behind an answer.
template <typename Parser>
class Dialogue {
 public:
  Dialogue(SerialPort& port, Parser& parser) : port_(port), parser_(parser) {}

  /// How long an answer may take: some ms of device and converter; the machine may be busy.
  static constexpr int kReply_ms = 200;

  /// Sends the question and hands on what comes, until `is_answer` says that this was it. False: it
  /// did not come within the time.
  template <typename IsAnswer>
  bool ask(Bytes question, int timeout_ms, IsAnswer&& is_answer) {
    port_.write(question);
    const Deadline deadline(timeout_ms);
    bool answered = false;
    std::array<std::uint8_t, 1024> bytes;
    for (int left = timeout_ms; !answered && left > 0; left = deadline.left_ms()) {
      const int count = read(bytes);
      // The time counts for data that follow the answer at once.
      parser_.feed({bytes.data(), static_cast<std::size_t>(count)}, clock_ns(CLOCK_MONOTONIC),
                   [&](const auto& frame) { answered = answered || is_answer(frame); });
      if (count == 0) port_.wait_readable(left);
    }
    return answered;
  }

  /// The same, three times if need be, to a device that sends nothing by itself.
  template <typename IsAnswer>
  bool ask_again(Bytes question, IsAnswer&& is_answer) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      parser_.reset();  // nothing comes that would end a frame with a false length
      if (ask(question, kReply_ms, is_answer)) return true;
    }
    return false;
  }

  /// Discards all bytes for `silence_ms`, then listens at another speed.
  void change_baud(unsigned baud, int silence_ms) {
    const Deadline deadline(silence_ms);
    std::array<std::uint8_t, 1024> ignored;
    for (int left = silence_ms; left > 0; left = deadline.left_ms()) {
      read(ignored);
      port_.wait_readable(left);
    }
    port_.set_baud(baud);
    parser_.reset();
  }

  /// The speed at which `answers()` is true: the configured one, or another of imu_bauds.
  /// InputError where it is none. `maker`: whose sensor it should be.
  template <typename Answers>
  unsigned find_baud(const ImuConfig& config, const char* maker, Answers&& answers) {
    std::vector<unsigned> bauds{config.baud};
    for (const unsigned baud : imu_bauds(config.protocol)) {
      if (baud != config.baud) bauds.push_back(baud);
    }
    for (const unsigned baud : bauds) {
      try {
        port_.set_baud(baud);
      } catch (const InputError&) {
        if (baud == config.baud) throw;
        continue;  // one that only the search wants
      }
      parser_.reset();
      for (int attempt = 0; attempt < 2; ++attempt) {
        if (answers()) return baud;
      }
    }
    std::sort(bauds.begin(), bauds.end());
    refuse(fmt::format("no answer at {} baud, {} bytes heard; is it {} sensor, powered, RX to TX?",
                       fmt::join(bauds, ", "), bytes_heard_, maker));
  }

  [[noreturn]] void refuse(const std::string& why) const { refuse_imu(port_.device(), why); }

 private:
  int read(std::span<std::uint8_t> into) {
    const int count = port_.read(into);
    if (count < 0) refuse("was unplugged while it was set up");
    bytes_heard_ += static_cast<std::uint64_t>(count);
    return count;
  }

  SerialPort& port_;
  Parser& parser_;
  std::uint64_t bytes_heard_ = 0;
};

}  // namespace sandrunner
