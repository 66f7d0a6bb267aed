// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rt/loop/rig.h"
#include "rt/operator/return_to_stand.h"
#include "rt/telemetry/view/view_control.h"
#include "sim/simulator.h"

namespace sandrunner {

/// What pages change in a simulated run in lockstep. What they ask for waits here for the next
/// boundary between two ticks.
class SimulatorControl final : public ViewControl, public BetweenTicks {
 public:
  /// `settings`: those in effect, TOML. `return_to_stand`: the run's operator; null: the run
  /// follows its command line. Both it and the simulator must outlive it.
  SimulatorControl(sim::Simulator& simulator, const sim::TerrainDescription& terrain,
                   std::string settings, ReturnToStand* return_to_stand);

  std::string push(double direction_rad) override;
  std::string set_on_legs() override;
  std::string set_ground(const WantedGround& wanted) override;
  GroundNow ground() const override;

  /// Does what waits.
  RobotNow act(std::uint64_t next, TickSinks sinks) override;

 private:
  RobotNow hold(std::uint64_t next, TickSinks sinks);

  sim::Simulator& simulator_;
  const std::string settings_;
  ReturnToStand* const return_to_stand_;
  const bool uneven_;
  bool holding_ = false;      // used by the thread of the ticks alone
  mutable std::mutex mutex_;  // of the rest
  GroundNow ground_;
  std::vector<double> pushes_rad_;
  bool set_on_legs_ = false;
  std::optional<sim::TerrainDescription> terrain_;
};

}  // namespace sandrunner
