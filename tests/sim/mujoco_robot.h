// SPDX-License-Identifier: BSD-3-Clause
// The robot in MuJoCo, which knows nothing of our block structure and contact solver: a model
// written from the same RobotModel.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

#include "rt/core/messages.h"
#include "sim/robot/dynamics.h"
#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

class MujocoRobot {
 public:
  /// On a level plane (z = 0, friction 0.8, nearly rigid) that only the feet touch, or in free
  /// flight.
  MujocoRobot(const RobotModel<double>& robot, bool on_ground) {
    const std::string xml = mjcf(robot, on_ground);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    char error[500] = "";
    model_ = mj_loadXML("robot.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model_ == nullptr) throw std::runtime_error(error);
    data_ = mj_makeData(model_);
  }
  ~MujocoRobot() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoRobot(const MujocoRobot&) = delete;
  MujocoRobot& operator=(const MujocoRobot&) = delete;

  const mjModel* model() const { return model_; }
  mjData* data() { return data_; }

  /// Both hold the base's velocity in world axes and its angular velocity in body axes.
  void set(const RigidState<double>& x) {
    const Quaternion<double>& o = x.orientation;
    const double position[7] = {x.position.x, x.position.y, x.position.z, o.w, o.x, o.y, o.z};
    const double velocity[6] = {x.velocity.x,         x.velocity.y,         x.velocity.z,
                                x.angular_velocity.x, x.angular_velocity.y, x.angular_velocity.z};
    std::copy_n(position, 7, data_->qpos);
    std::copy_n(velocity, 6, data_->qvel);
    std::copy_n(x.q.begin(), kNumJoints, data_->qpos + 7);
    std::copy_n(x.qd.begin(), kNumJoints, data_->qvel + 6);
  }
  RigidState<double> state() const {
    const double *p = data_->qpos, *v = data_->qvel;
    RigidState<double> x;
    x.position = {p[0], p[1], p[2]};
    x.orientation = {p[3], p[4], p[5], p[6]};
    x.velocity = {v[0], v[1], v[2]};
    x.angular_velocity = {v[3], v[4], v[5]};
    std::copy_n(p + 7, kNumJoints, x.q.begin());
    std::copy_n(v + 6, kNumJoints, x.qd.begin());
    return x;
  }
  /// Joint torques until further notice.
  void apply(const std::array<double, kNumJoints>& torque_nm) {
    std::copy_n(torque_nm.begin(), kNumJoints, data_->qfrc_applied + 6);
  }
  void step() { mj_step(model_, data_); }

 private:
  static std::string text(const Vec3<double>& v) {
    return fmt::format("{:.17g} {:.17g} {:.17g}", v.x, v.y, v.z);
  }
  // MuJoCo's own reader diagonalises `fullinertia` to 1e-7 only, so the principal axes are given.
  static std::string inertial(const Body<double>& b) {
    const Sym3<double>& i = b.inertia;
    Eigen::Matrix3d inertia;
    inertia << i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
    Eigen::Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
    const Eigen::Quaterniond q(axes);
    const Eigen::Vector3d& d = principal.eigenvalues();
    return fmt::format(
        "<inertial pos='{}' mass='{:.17g}' quat='{:.17g} {:.17g} {:.17g} {:.17g}' "
        "diaginertia='{}'/>",
        text(b.com), b.mass, q.w(), q.x(), q.y(), q.z(), text({d[0], d[1], d[2]}));
  }
  static std::string mjcf(const RobotModel<double>& m, bool on_ground) {
    // Contacts stiff enough to yield a tenth of a millimetre, overdamped.
    const std::string contact = "friction='0.8' condim='3' solref='0.002 1'";
    std::string xml = fmt::format(
        "<mujoco><compiler angle='radian'/><option gravity='0 0 -9.81' timestep='{}' "
        "cone='elliptic'><flag contact='{}'/></option><worldbody>"
        "<geom type='plane' size='0 0 1' {}/><body name='base'><freejoint/>{}",
        kControlPeriod_s, on_ground ? "enable" : "disable", contact, inertial(m.base));
    for (int l = 0; l < kNumLegs; ++l) {
      const LegModel<double>& leg = m.legs[l];
      const auto body = [&](const char* link, int joint, const Vec3<double>& at, const char* axis,
                            const Body<double>& b) {
        return fmt::format("<body name='{}{}' pos='{}'><joint axis='{}' armature='{:.17g}'/>{}",
                           link, l, text(at), axis, m.rotor_inertia[3 * l + joint], inertial(b));
      };
      xml += body("hip", 0, leg.haa, "1 0 0", leg.hip) +
             body("thigh", 1, leg.hfe, "0 1 0", leg.thigh) +
             body("shank", 2, leg.kfe, "0 1 0", leg.shank) +
             fmt::format("<geom type='sphere' size='{}' pos='{}' {} mass='0'/>", m.foot_radius_m,
                         text(leg.foot), contact) +
             "</body></body></body>";
    }
    return xml + "</body></worldbody></mujoco>";
  }

  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

}  // namespace sandrunner::sim
