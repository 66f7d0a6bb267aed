// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rt/loop/rig.h"
#include "rt/operator/stand_again.h"
#include "rt/telemetry/view/view_hand.h"
#include "sim/simulator.h"

namespace sandrunner {

/// The hand of pages in a simulated run in lockstep. What they ask for waits here for the next
/// boundary between two ticks.
class SimulatorHand final : public ViewHand, public BetweenTicks {
 public:
  /// `settings`: those in effect, TOML. `stand_again`: the run's operator; null: the run follows
  /// its command line. Both it and the simulator must outlive the hand.
  SimulatorHand(sim::Simulator& simulator, const sim::TerrainDescription& terrain,
                std::string settings, StandAgain* stand_again);

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
  StandAgain* const stand_again_;
  const bool uneven_;
  bool holding_ = false;      // used by the thread of the ticks alone
  mutable std::mutex mutex_;  // of the rest
  GroundNow ground_;
  std::vector<double> pushes_rad_;
  bool set_on_legs_ = false;
  std::optional<sim::TerrainDescription> terrain_;
};

}  // namespace sandrunner
