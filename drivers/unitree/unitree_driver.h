// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/unitree/unitree_config.h"
#include "drivers/unitree/wire_process.h"
#include "rt/core/robot_description.h"
#include "rt/core/robot_driver.h"

namespace sandrunner {

/// The driver of Unitree's robots (unitree_robot.h).
class UnitreeDriver final : public RobotDriver {
 public:
  UnitreeDriver(const UnitreeConfig& config, const RobotDescription& robot);
  /// Reads the settings (read_unitree_config).
  UnitreeDriver(ConfigTree& config, const RobotDescription& robot, const GateConfig& limits);

  const UnitreeConfig& config() const noexcept { return config_; }

  void fit_gate(GateConfig& gate) const noexcept override;
  void fit_to(const ControllerConfig& controller) override;
  int check(const CheckTask& task) const override;
  void fork_processes() override;
  std::unique_ptr<RobotIo> connect() override;
  std::vector<std::string> warnings() const override;
  std::string dry_run(const StandConfig& stand) const override;
  std::string report(const RobotIo& robot) const override;

 private:
  const UnitreeConfig config_;
  const RobotDescription description_;
  unitree::RobotFigures robot_;                 // of fit_to()
  std::unique_ptr<unitree::WireProcess> wire_;  // from fork_processes() to connect()
};

}  // namespace sandrunner
