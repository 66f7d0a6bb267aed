// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/scene.h"

#include "rt/run/robot_scene.h"
#include "sim/ground/terrain_description.h"

namespace sandrunner {

RunScene scene_of(const ProcessConfig& config, const std::string& policy) {
  const sim::TerrainDescription& terrain = config.simulator.terrain;
  const sim::RobotModel<double>& model = config.robot.model;
  RunScene scene = robot_scene(
      config.robot, sim::make_terrain(terrain, sim::make_foot_profile(terrain, model), model),
      terrain.shape.heights);
  scene.terrain = terrain.name;
  scene.policy = policy;
  if (config.controller.gate.hanging) scene.note = "The robot hangs: it may not walk.";
  scene.motor_constant = config.motor_constant;
  return scene;
}

}  // namespace sandrunner
