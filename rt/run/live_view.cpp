// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/live_view.h"

#include <fmt/format.h>

#include "rt/base/standard_error.h"

namespace sandrunner {

LiveView::LiveView(const RunScene& scene, const ProcessConfig& config, RunClock clock,
                   const std::atomic<int>& interrupts, Operators& operators,
                   sim::Simulator* simulator)
    : feed_(scene), topics_(scene.robot) {
  if (clock == RunClock::kLockstep) pace_.emplace(interrupts);
  if (pace_ && simulator) {
    control_.emplace(*simulator, config.simulator.terrain, config.effective,
                     operators.return_to_stand());
  }
  server_.emplace(config.view_port,
                  ViewServer::Parts{.feed = feed_,
                                    .pace = pace_ ? &*pace_ : nullptr,
                                    .desk = config.view_drive ? operators.desk() : nullptr,
                                    .control = control_ ? &*control_ : nullptr,
                                    .topics = &topics_});
  to_standard_error(fmt::format("sandrunner: look at {}\n", server_->url()));
}

RobotNow LiveView::act(std::uint64_t next, TickSinks sinks) {
  pace_->wait();
  return control_ ? control_->act(next, sinks) : RobotNow::kAsBefore;
}

}  // namespace sandrunner
