// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

#include "rt/report/run_record.h"
#include "sim/ground/terrain.h"
#include "sim/robot/robot_model.h"

namespace sandrunner {

/// The scene of a robot on simulated ground, without names. `Real`: double, or the float of
/// trainings.
template <typename Real>
RunScene robot_scene(const sim::Robot& robot, sim::Terrain<Real> ground) {
  const sim::RobotModel<double>& model = robot.model;
  RunScene scene;
  scene.robot = robot.description;
  scene.mass_kg = model.mass();
  scene.motor_constant = robot.motor_constant_nmpsqrtw;
  scene.foot_radius_m = model.foot_radius_m;
  scene.granular_ground = ground.ground[0].is_granular > Real(0.0);
  if (ground.highest > Real(0.0)) {
    const auto shared = std::make_shared<const sim::Terrain<Real>>(std::move(ground));
    scene.waves_m = [shared](double x_m, double y_m) -> double {
      return sim::surface_at(*shared, static_cast<Real>(x_m), static_cast<Real>(y_m)).height;
    };
  }
  return scene;
}

}  // namespace sandrunner
