// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <optional>

#include "rt/loop/clock.h"
#include "rt/loop/rig.h"
#include "rt/run/operators.h"
#include "rt/run/run.h"
#include "rt/run/simulator_control.h"
#include "rt/telemetry/view/live_topics.h"
#include "rt/telemetry/view/view_feed.h"
#include "rt/telemetry/view/view_pace.h"
#include "rt/telemetry/view/view_server.h"

namespace sandrunner {

/// A run in a browser (--view): what pages see, and in lockstep what they do between two ticks.
class LiveView final : public BetweenTicks {
 public:
  /// Prints the address. `simulator`: null for a real robot. Throws InputError if the port is
  /// taken. All arguments must outlive the view.
  LiveView(const RunScene& scene, const ProcessConfig& config, RunClock clock,
           const std::atomic<int>& interrupts, Operators& operators, sim::Simulator* simulator);

  RobotNow act(std::uint64_t next, TickSinks sinks) override;
  /// The view acts between ticks: the run is in lockstep.
  bool has_pace() const noexcept { return pace_.has_value(); }
  ViewFeed& feed() noexcept { return feed_; }
  LiveTopics& topics() noexcept { return topics_; }

 private:
  ViewFeed feed_;
  LiveTopics topics_;
  std::optional<ViewPace> pace_;
  std::optional<SimulatorControl> control_;
  std::optional<ViewServer> server_;
};

}  // namespace sandrunner
