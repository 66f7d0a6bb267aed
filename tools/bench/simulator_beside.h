// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "rt/core/robot_io.h"
#include "rt/core/triple_buffer.h"
#include "sim/simulator.h"

namespace sandrunner::bench {

/// The simulator in a thread of its own, 500 times a second: the control thread exchanges values
/// with it as with the process of a Unitree robot's wire, and simulates nothing itself. Lies on its
/// belly at the start.
class SimulatorBeside final : public RobotIo {
 public:
  /// `priority`: SCHED_FIFO of the thread, where permitted.
  SimulatorBeside(const sim::Robot& robot, const sim::SimulatorConfig& config, int priority);
  ~SimulatorBeside() override;
  SimulatorBeside(const SimulatorBeside&) = delete;
  SimulatorBeside& operator=(const SimulatorBeside&) = delete;

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override;
  void write(const SafeCommand& command) noexcept override { commands_.write(command); }
  void cut_drives() noexcept override { cut_ = true; }
  void shut_down() noexcept override {}

 private:
  struct Sensed {
    SensorFrame frame;
    std::int64_t sampled_ns = 0;
  };
  void simulate() noexcept;

  sim::Simulator simulator_;
  TripleBuffer<SafeCommand> commands_;
  TripleBuffer<Sensed> sensed_;
  std::uint64_t seen_ = 0;
  std::atomic<bool> cut_{false}, end_{false};
  std::thread thread_;
};

}  // namespace sandrunner::bench
