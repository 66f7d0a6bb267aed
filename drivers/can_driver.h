// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/robot/can_guard.h"
#include "drivers/robot/hardware_config.h"
#include "rt/core/gate_config.h"
#include "rt/core/robot_description.h"
#include "rt/core/robot_driver.h"

namespace sandrunner {

/// The driver of robots whose drives are on CAN buses (drivers/robot, drivers/check).
class CanDriver final : public RobotDriver {
 public:
  /// Reads the settings (read_hardware_config).
  CanDriver(ConfigTree& config, const RobotDescription& robot, const GateConfig& limits);

  const HardwareConfig& config() const noexcept { return config_; }

  void fit_gate(GateConfig& gate) const noexcept override;
  void fit_to(const ControllerConfig& controller) override;
  int check(const CheckTask& task) const override;
  /// The guard of drives whose time-out is not verified.
  void fork_processes() override;
  std::unique_ptr<RobotIo> connect() override;
  std::vector<std::string> warnings() const override;
  std::string dry_run(const StandConfig& stand) const override;
  std::string report(const RobotIo& robot) const override;

 private:
  HardwareConfig config_;
  const RobotDescription robot_;
  GateConfig gate_;                  // of fit_to()
  std::unique_ptr<CanGuard> guard_;  // until connect(); null: none is needed
};

}  // namespace sandrunner
