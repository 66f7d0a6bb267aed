// SPDX-License-Identifier: BSD-3-Clause
#include "tools/sandbox/run.h"

#include <cmath>

#include "rt/core/mode_machine.h"
#include "rt/operator/mode_requests.h"
#include "rt/run/robot_scene.h"
#include "rt/telemetry/view/view_control.h"

namespace sandrunner::sandbox {
namespace {

// More would only be sent anew if the robot came back.
constexpr std::size_t kMostTilesSeen = 1024;

PolicyRunner policy_of(const Setup& setup) {
  if (const auto* network = std::get_if<NetworkParameters>(&setup.network)) {
    return PolicyRunner(Policy(setup.policy, Network(*network)));
  }
  if (const auto* network = std::get_if<PerceptronParameters>(&setup.network)) {
    return PolicyRunner(Policy(setup.policy, Perceptron(*network, setup.policy.nominal_position_rad,
                                                        setup.policy.action_clip)));
  }
  return {};
}

const char* no_walk_of(const Setup& setup) {
  return no_walk(setup.controller.gate, setup.network.index() != 0);
}

RunScene scene_of(const Setup& setup) {
  const sim::TerrainDescription& terrain = setup.simulator.terrain;
  const sim::RobotModel<double>& model = setup.robot.model;
  RunScene scene = robot_scene(
      setup.robot, sim::make_terrain(terrain, sim::make_foot_profile(terrain, model), model));
  scene.motor_constant = setup.motor_constant;
  return scene;
}

}  // namespace

Robot::Robot(const Setup& setup, const ControllerConfig& controller, Mode start)
    : policy(policy_of(setup)),
      simulator(setup.robot, setup.simulator),
      loop(simulator, controller, start, policy) {
  if (start == Mode::kPassive) simulator.reset_lying();
}

std::uint64_t Robot::state_hash() {
  StateHash hash;
  simulator.add_to(hash);
  loop.add_to(hash);
  return hash.value();
}

ScriptedRun::ScriptedRun(const Setup& setup, const VelocityCommand& constant, const RunPlan& plan)
    : command(constant),
      script(command, plan, no_walk_of(setup) == nullptr),
      robot(setup, setup.controller, plan.start_walking ? Mode::kWalk : Mode::kPassive) {}

bool ScriptedRun::advance(int ticks) {
  for (int i = 0; i < ticks; ++i) {
    if (robot.loop.tick(script, 0) == AfterTick::kEnd) return false;
  }
  return true;
}

PageRun::PageRun(const Setup& setup)
    : no_walk_(no_walk_of(setup)),
      terrain_(setup.simulator.terrain),
      robot_(setup, setup.page_controller, Mode::kPassive),
      remote_(setup.stale_ticks),
      scene_(scene_of(setup)) {}

void PageRun::advance(int ticks) {
  rows.clear();
  footprints.clear();
  tiles.clear();
  for (int i = 0; i < ticks; ++i) {
    robot_.loop.tick(operator_, 0);
    see();
    if (!operator_.holds()) continue;
    if (robot_.simulator.carry_to_stand()) operator_.is_upright();
    robot_.loop.robot_changed();
  }
}

void PageRun::see() {
  const std::optional<RunRow> row = maker_.add(robot_.loop.record());
  if (!row) return;
  if (tiles_seen_.size() > kMostTilesSeen) tiles_seen_.clear();
  const std::vector<ViewTile> new_tiles = new_view_tiles(scene_, *row, tiles_seen_);
  tiles.insert(tiles.end(), new_tiles.begin(), new_tiles.end());
  for (const Footprint& print : maker_.take_footprints()) {
    if (print.shows()) footprints.push_back(print);
  }
  rows.push_back(*row);
}

void PageRun::drive(const VelocityCommand& command) {
  asked_.velocity = command;
  ++asked_.velocity_number;
  remote_.ask(asked_);
}

const char* PageRun::request(std::size_t row) {
  const RequestDecision decision = decide(kRequestTable[row].name, remote_.mode(), no_walk_);
  if (decision.refusal || decision.request == ModeRequest::kNone) return decision.refusal;
  asked_.request = decision.request;
  ++asked_.request_number;
  remote_.ask(asked_);
  advance(1);
  return failure(decision.request, remote_.mode());
}

void PageRun::push(double direction_rad) {
  robot_.simulator.push(kPush_mps * std::cos(direction_rad), kPush_mps * std::sin(direction_rad));
  robot_.loop.robot_changed();
}

void PageRun::set_terrain(const sim::TerrainDescription& terrain) {
  terrain_ = terrain;
  robot_.simulator.set_terrain(terrain_);
  robot_.loop.robot_changed();
}

double PageRun::now_s() const {
  return static_cast<double>(robot_.loop.next_tick()) * kControlPeriod_s;
}

}  // namespace sandrunner::sandbox
