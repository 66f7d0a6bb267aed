// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/robot_settings.h"

#include <fmt/format.h>

#include <cmath>

#include "tools/train/task/embedded.h"

namespace sandrunner::train {
namespace {

// Raibo's mass and nominal height, of which its settings are known to be good.
constexpr double kMass_kg = 26.817, kHeight_m = 0.4725;

}  // namespace

std::string robot_settings(const sim::Robot& robot) {
  const double length = robot.nominal_height_m / kHeight_m;
  const double speed = std::sqrt(length);
  const double weight = robot.model.mass() / kMass_kg;
  const double knee_low_rad = robot.model.lower_rad[2], knee_high_rad = robot.model.upper_rad[2];
  return fmt::format(
      "[policy]\naction_scale_rad = 0.3\nkp_nmprad = {}\nkd_nmsprad = {}\nbody_height_m = {}\n"
      "[robot]\nbase_com_m = [{}, {}, {}]\n"
      "[command]\nspeed_start_mps = {}\nspeed_max_mps = {}\nspeed_step_mps = {}\n"
      "backward_mps = {}\nlateral_mps = {}\n"
      "[reward]\ntorque = {}\npower = {}\njoint_speed = {}\nclearance_m = {}\nknee_low_rad = {}\n"
      "knee_high_rad = {}\nheight_m = {}\nheight_end_m = {}\n",
      0.5 * robot.stand_kp_nmprad, 0.5 * robot.stand_kd_nmsprad, 0.48 * length,  //
      0.03 * length, 0.02 * length, 0.015 * length,                              //
      speed, 4.0 * speed, 0.02 * speed, speed, 0.5 * speed,                      //
      1.0e-3 / (weight * length * weight * length), 8.0e-3 / (weight * speed), 3e-4 * length,
      0.08 * length, knee_low_rad + 0.12, knee_high_rad - 0.12, 0.475 * length, 0.495 * length);
}

void add_training_layers(ConfigTree& config, const sim::Robot& robot) {
  config.add_text(embedded_train_file("training.toml"), "training.toml");
  const std::string& name = robot.description.name;
  config.add_text(robot_settings(robot), fmt::format("robot '{}'", name));
  if (name == "raibo") config.add_text(embedded_train_file("raibo.toml"), "raibo.toml");
}

}  // namespace sandrunner::train
