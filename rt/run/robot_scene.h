// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

#include "rt/report/run_record.h"
#include "sim/ground/height_grid.h"
#include "sim/ground/terrain.h"
#include "sim/robot/robot_model.h"

namespace sandrunner {

/// The scene of a robot on simulated ground, without names. `Real`: double, or the float of
/// trainings.
template <typename Real>
RunScene robot_scene(const sim::Robot& robot, const sim::Terrain<Real>& ground,
                     const std::shared_ptr<const sim::HeightGrid>& heights = {}) {
  const sim::RobotModel<double>& model = robot.model;
  RunScene scene;
  scene.robot = robot.description;
  scene.mass_kg = model.mass();
  scene.motor_constant = robot.motor_constant_nmpsqrtw;
  scene.foot_radius_m = model.foot_radius_m;
  scene.granular_ground = sim::Laws::kDrawnAsSand[static_cast<int>(ground.ground[0].kind)];
  sim::Shape<Real> waves = ground.shape;
  scene.slope = {std::exchange(waves.slope_x, Real(0.0)), std::exchange(waves.slope_y, Real(0.0))};
  if (waves.crest > Real(0.0)) {
    scene.waves_m = [waves, heights](double x_m, double y_m) -> double {
      const sim::Relief<Real> relief{{heights.get()}};
      return sim::surface_at(waves, relief, static_cast<Real>(x_m), static_cast<Real>(y_m)).height;
    };
  }
  return scene;
}

}  // namespace sandrunner
