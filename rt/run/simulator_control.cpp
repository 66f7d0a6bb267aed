// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/simulator_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/run/offered_ground.h"

namespace sandrunner {
namespace {

GroundNow describe(const sim::TerrainDescription& terrain, const WantedGround& wanted) {
  const sim::GroundParameters& ground = terrain.patches.front().ground;
  GroundNow now;
  now.wanted = wanted;
  now.name = terrain.name;
  now.kind = sim::kind_name(ground.kind);
  now.granular = sim::Laws::kDrawnAsSand[static_cast<int>(ground.kind)];
  now.presets = sim::terrain_preset_names();
  for (const auto& [key, member] : kOfferedGround) now.values.emplace_back(key, ground.*member);
  return now;
}

// Throws InputError: the line that --set gives, but for its own name.
sim::TerrainDescription read(const WantedGround& wanted, const std::string& settings) {
  ConfigTree tree;
  if (wanted.preset.empty()) {
    tree.add_text(settings, "the run's settings");
  } else if (std::ranges::count(sim::terrain_preset_names(), wanted.preset) == 1) {
    sim::add_terrain_layer(tree, wanted.preset);
  } else {
    throw InputError(fmt::format("terrain: '{}', expected one of {}", one_line(wanted.preset),
                                 fmt::join(sim::terrain_preset_names(), ", ")));
  }
  std::vector<std::string_view> keys;
  for (const auto& [key, member] : kOfferedGround) keys.emplace_back(key);
  for (const auto& [key, value] : wanted.set) {
    if (std::ranges::count(keys, key) == 0) {
      throw InputError(
          fmt::format("terrain: '{}', expected one of {}", one_line(key), fmt::join(keys, ", ")));
    }
    tree.set(fmt::format("terrain.{}={}", key, value), "page");
  }
  return sim::read_terrain(tree);
}

void note(TickSinks sinks, std::uint64_t next, const std::string& kind, const std::string& text) {
  for (TickSink* sink : sinks) sink->note(next, kind, text);
}

std::string text_of(const WantedGround& wanted) {
  std::string text = wanted.preset.empty() ? "as the run began" : wanted.preset;
  for (const auto& [key, value] : wanted.set) text += fmt::format(" {}={}", key, value);
  return text;
}

}  // namespace

SimulatorControl::SimulatorControl(sim::Simulator& simulator,
                                   const sim::TerrainDescription& terrain, std::string settings,
                                   ReturnToStand* return_to_stand)
    : simulator_(simulator),
      settings_(std::move(settings)),
      return_to_stand_(return_to_stand),
      uneven_(simulator.terrain().shape.uneven > 0.0),
      ground_(describe(terrain, {})) {}

std::string SimulatorControl::push(double direction_rad) {
  const std::lock_guard lock(mutex_);
  constexpr std::size_t kMost = 16;  // while the robot's time stands still
  if (pushes_rad_.size() == kMost) return "enough pushes wait for the next tick";
  pushes_rad_.push_back(direction_rad);
  return {};
}

std::string SimulatorControl::set_on_legs() {
  if (!return_to_stand_) {
    return "this run follows its command line: only with --command live is the robot set on its "
           "legs";
  }
  const std::lock_guard lock(mutex_);
  set_on_legs_ = true;
  return {};
}

std::string SimulatorControl::set_ground(const WantedGround& wanted) {
  if (uneven_ && !wanted.preset.empty())
    return "uneven ground cannot be changed for another preset";
  try {
    sim::TerrainDescription terrain = read(wanted, settings_);
    const std::lock_guard lock(mutex_);
    ground_ = describe(terrain, wanted);
    terrain_ = std::move(terrain);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

GroundNow SimulatorControl::ground() const {
  const std::lock_guard lock(mutex_);
  return ground_;
}

RobotNow SimulatorControl::act(std::uint64_t next, TickSinks sinks) {
  RobotNow now = RobotNow::kAsBefore;
  {
    const std::lock_guard lock(mutex_);
    if (terrain_) {
      simulator_.set_terrain(*terrain_);
      terrain_.reset();
      note(sinks, next, "terrain", text_of(ground_.wanted));
      now = RobotNow::kChanged;
    }
    for (const double direction_rad : std::exchange(pushes_rad_, {})) {
      simulator_.push(kPush_mps * std::cos(direction_rad), kPush_mps * std::sin(direction_rad));
      note(sinks, next, "push",
           fmt::format("{} m/s towards {:.0f} degrees", kPush_mps,
                       direction_rad * (180.0 / std::numbers::pi)));
      now = RobotNow::kChanged;
    }
    if (std::exchange(set_on_legs_, false)) return_to_stand_->begin();
  }
  return hold(next, sinks) == RobotNow::kChanged ? RobotNow::kChanged : now;
}

// Upright, until it carries itself.
RobotNow SimulatorControl::hold(std::uint64_t next, TickSinks sinks) {
  const bool holds = return_to_stand_ && return_to_stand_->holds();
  if (holds != holding_) {
    note(sinks, next, "hand", holds ? "sets the robot on its legs" : "lets it go");
  }
  holding_ = holds;
  if (holds && simulator_.carry_to_stand()) return_to_stand_->is_upright();
  return holds ? RobotNow::kChanged : RobotNow::kAsBefore;
}

}  // namespace sandrunner
