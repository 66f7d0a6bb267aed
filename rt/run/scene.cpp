// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/scene.h"

#include <memory>

#include "sim/ground/terrain_description.h"

namespace sandrunner {

RunScene scene_of(const ProcessConfig& config, const std::string& policy) {
  const sim::RobotModel<double>& model = config.robot.model;
  const auto array = [](const sim::Vec3<double>& v) { return Vector3{v.x, v.y, v.z}; };
  RunScene scene;
  scene.terrain = config.simulator.terrain.name;
  scene.policy = policy;
  if (config.controller.gate.hanging) scene.note = "The robot hangs: it may not walk.";
  scene.robot = config.robot.description;
  scene.mass_kg = model.mass();
  scene.motor_constant = config.motor_constant;
  scene.base_box_size_m = array(2.0 * model.base_box_half_m);
  scene.base_box_center_m = array(model.base_box_centre_m);
  scene.foot_radius_m = model.foot_radius_m;
  scene.granular_ground =
      config.simulator.terrain.patches.front().ground.kind == sim::GroundKind::kGranular;
  const auto terrain = std::make_shared<const sim::Terrain<double>>(sim::make_terrain(
      config.simulator.terrain, sim::make_foot_profile(config.simulator.terrain, model), model));
  if (terrain->highest > 0.0) {
    scene.ground_height_m = [terrain](double x_m, double y_m) {
      return sim::surface_at(*terrain, x_m, y_m).height;
    };
  }
  return scene;
}

}  // namespace sandrunner
