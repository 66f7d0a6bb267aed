// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/simulated/plain_task.h"

#include "rt/core/messages.h"
#include "sim/ground/terrain_description.h"
#include "tools/train/task/robot_settings.h"

namespace sandrunner::study {
namespace {

constexpr double kNever = 1e6;  // s; longer than any run
constexpr double kFastest_mps = 3.0;

}  // namespace

train::TaskConfig plain_task(const sim::Robot& robot) {
  train::TaskConfig c = train::without_variety(train::shipped_task_config(robot));
  c.episode.reset_nominal_share = 0.0;
  c.noise.level_high = c.noise.joint_offset_rad = 0.0;
  return c;
}

train::TaskConfig grid_task(const sim::Robot& robot, const GridCell& cell) {
  train::TaskConfig c = plain_task(robot);
  c.command.speed_start_mps = c.command.speed_max_mps = kFastest_mps;
  c.command.change_s = kNever;
  c.command.ramp_share = c.command.forward_ramp_share = 0.0;
  c.command.zero_share = c.command.in_place_share = 0.0;
  const sim::GroundParameters usual;
  train::GroundSettings& g = c.ground;
  g.sigma_flat_low_start = g.sigma_flat_low = g.sigma_flat_high = cell.sigma_flat_npm3;
  g.sigma_cone_low_start = g.sigma_cone_low = g.sigma_cone_high = cell.sigma_cone_npm3;
  g.friction_low = g.friction_high = usual.friction;
  g.recruitment_spread = g.cone_angle_spread_deg = 0.0;
  g.inertial_low = g.inertial_high = 1.0;
  g.stroke_stiffness_low = g.stroke_stiffness_high = usual.stroke_stiffness_npm;
  g.stroke_damping_low = g.stroke_damping_high = usual.stroke_damping_nspm;
  return c;
}

double static_depth_m(const sim::Robot& robot, const GridCell& cell) {
  sim::GroundParameters parameters;
  parameters.sigma_flat_npm3 = cell.sigma_flat_npm3;
  parameters.sigma_cone_npm3 = cell.sigma_cone_npm3;
  const sim::FootProfile<double> foot = sim::make_foot_profile({}, robot.model);
  const sim::Ground<double> ground =
      sim::derive_ground(parameters, foot, robot.model.foot_radius_m);
  const double load_n = robot.model.mass() * kGravity_mps2 / kNumLegs;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {  // halved until a double has no more digits
    const double middle = 0.5 * (low + high);
    (sim::quasistatic_force(ground, foot, middle) < load_n ? low : high) = middle;
  }
  return high;
}

}  // namespace sandrunner::study
