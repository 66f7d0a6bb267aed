// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/scene.h"

#include "sim/ground/terrain.h"
#include "sim/ground/terrain_description.h"
#include "sim/robot/dynamics.h"

namespace sandrunner {

RunScene scene_of(const ProcessConfig& config, const std::string& policy) {
  const sim::RobotModel<double>& model = config.robot.model;
  const auto array = [](const sim::Vec3<double>& v) { return Vector3{v.x, v.y, v.z}; };
  RunScene scene;
  scene.terrain = config.simulator.terrain.name;
  scene.policy = policy;
  if (config.controller.gate.hanging) scene.note = "The robot hangs: it may not walk.";
  scene.leg_names = config.robot.description.leg_names;
  scene.joint_names = config.robot.description.joint_names;
  scene.mass_kg = model.mass();
  scene.motor_constant = config.motor_constant;
  scene.base_box_size_m = array(2.0 * model.base_box_half_m);
  scene.base_box_center_m = array(model.base_box_centre_m);
  scene.foot_radius_m = model.foot_radius_m;
  scene.leg_points = [legs = model.legs, array](const JointArray<double>& q) {
    std::array<LegPoints, kNumLegs> points;
    for (std::size_t l = 0; l < kNumLegs; ++l) {
      const sim::LegPose<double> p = sim::leg_pose(legs[l], q[3 * l], q[3 * l + 1], q[3 * l + 2]);
      points[l] = {array(sim::hip_to_base(legs[l], p, legs[l].hfe)),
                   array(sim::hip_to_base(legs[l], p, p.knee)),
                   array(sim::hip_to_base(legs[l], p, p.foot))};
    }
    return points;
  };
  const sim::TerrainDescription& ground = config.simulator.terrain;
  scene.granular_ground = ground.patches.front().ground.kind == sim::GroundKind::kGranular;
  const sim::Terrain<double> terrain =
      sim::make_terrain(ground, sim::make_foot_profile(ground, model), model);
  if (terrain.highest > 0.0) {
    scene.ground_height_m = [terrain](double x_m, double y_m) {
      return sim::surface_at(terrain, x_m, y_m).height;
    };
  }
  return scene;
}

}  // namespace sandrunner
