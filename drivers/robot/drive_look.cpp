// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/drive_look.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "drivers/can/can_error.h"
#include "rt/base/clock_ns.h"

namespace sandrunner {

DriveLook::DriveLook(const HardwareConfig& config, const CanSockets& sockets)
    : config_(config),
      sockets_(sockets),
      buses_(sockets.size()),
      start_ns_(clock_ns(CLOCK_MONOTONIC)) {
  for (int j = 0; j < kNumJoints; ++j) drives_[j] = Drive(config.drives[j], config);
}

std::uint64_t DriveLook::tick() const noexcept {
  return static_cast<std::uint64_t>((clock_ns(CLOCK_MONOTONIC) - start_ns_) / kControlPeriod_ns);
}

void DriveLook::exchange() {
  for (int j = 0; j < kNumJoints; ++j) {
    CanFrame frame;
    drives_[j].off_frame(frame);
    send(j, frame);
  }
  receive(kExchange_s);
}

void DriveLook::exchange_powered(const JointArray<std::optional<SetPoint>>& points) {
  const std::uint64_t now = tick();
  for (int j = 0; j < kNumJoints; ++j) {
    CanFrame frame;
    if (drives_[j].next_frame(points[j] ? &*points[j] : nullptr, now, frame)) send(j, frame);
  }
  receive(1.0 / config_.rate_hz);
}

void DriveLook::send(int j, const CanFrame& frame) {
  const int bus = config_.drives[j].bus;
  if (!sockets_[bus]) return;
  ++found_[j].requests;
  sent_ns_[j] = clock_ns(CLOCK_REALTIME);
  if (sockets_[bus]->send({&frame, 1}).frames == 0) ++buses_[bus].not_sent;
}

void DriveLook::receive(double wait_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
  for (std::size_t b = 0; b < sockets_.size(); ++b) {
    if (!sockets_[b]) continue;
    for_each_frame(*sockets_[b], 10, [&](const ReceivedFrame& frame) { take(b, frame); });
  }
  for (int j = 0; j < kNumJoints; ++j) {
    found_[j].position_rad = drives_[j].position_rad();
    found_[j].fault = drives_[j].fault();
    found_[j].temperature_degc = drives_[j].temperature_degc();
    found_[j].voltage_v = drives_[j].voltage_v();
  }
}

void DriveLook::take(std::size_t bus, const ReceivedFrame& received) {
  if (received.frame.error) {
    ++buses_[bus].error_frames;
    const CanError error = decode_can_error(received.frame);
    buses_[bus].error = words(error);
    for (int j = 0; error.bus_off && j < kNumJoints; ++j) {
      if (config_.drives[j].bus == static_cast<int>(bus)) drives_[j].lose_bus();
    }
    return;
  }
  for (int j = 0; j < kNumJoints; ++j) {
    if (config_.drives[j].bus != static_cast<int>(bus)) continue;
    if (!drives_[j].take(received.frame, tick())) continue;
    FoundDrive& f = found_[j];
    ++f.replies;
    if (received.stamp_ns == 0) return;  // the adapter gives none
    const double trip_s = 1e-9 * static_cast<double>(received.stamp_ns - sent_ns_[j]);
    f.longest_round_trip_s = std::max(f.longest_round_trip_s, trip_s);
    f.round_trip_s += (trip_s - f.round_trip_s) / f.replies;
    return;
  }
  bool is_command = false;
  for (int j = 0; j < kNumJoints; ++j) {
    if (config_.drives[j].bus != static_cast<int>(bus)) continue;
    if (!drives_[j].is_command(received.frame)) continue;
    is_command = true;
    ++found_[j].commands;
  }
  if (!is_command) ++buses_[bus].foreign;
}

JointArray<double> DriveLook::position_rad() const noexcept {
  JointArray<double> positions;
  for (int j = 0; j < kNumJoints; ++j) positions[j] = found_[j].position_rad;
  return positions;
}

}  // namespace sandrunner
