// SPDX-License-Identifier: BSD-3-Clause
// The robot in MuJoCo, which knows nothing of our block structure and contact solver: a model
// written from the same RobotModel.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "rt/core/messages.h"
#include "sim/robot/dynamics.h"
#include "sim/robot/robot_model.h"

namespace sandrunner::bench {

/// What MuJoCo's own defaults are not to be, as attributes of MJCF; the step is a control tick's.
struct MujocoSettings {
  std::string option{};                               ///< of <option>
  std::string contact = "friction='0.8' condim='3'";  ///< of each <geom>
  bool on_ground = true;                              ///< else in free flight
};

/// On a level plane (z = 0), which only the four feet touch, as balls; at the origin, joints at 0.
/// Positions in m, speeds in m/s, angles in rad; base velocity in world axes, angular velocity in
/// body axes, as in RigidState. Throws std::runtime_error with MuJoCo's words.
class MujocoRobot {
 public:
  MujocoRobot(const sim::RobotModel<double>& robot, const MujocoSettings& settings);

  const mjModel* model() const { return model_.get(); }
  mjData* data() { return data_.get(); }
  const mjData* data() const { return data_.get(); }

  void set(const sim::RigidState<double>& x);
  sim::RigidState<double> state() const;
  /// Joint torques, N m, until further notice.
  void apply(const JointArray<double>& torque_nm);
  void step() { mj_step(model_.get(), data_.get()); }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

}  // namespace sandrunner::bench
