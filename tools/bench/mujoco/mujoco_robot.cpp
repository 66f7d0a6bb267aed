// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/mujoco/mujoco_robot.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace sandrunner::bench {
namespace {

std::string text(const sim::Vec3<double>& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x, v.y, v.z);
}

// MuJoCo's own reader diagonalises `fullinertia` to 1e-7 only, so the principal axes are given.
std::string inertial(const sim::Body<double>& b) {
  const sim::Sym3<double>& i = b.inertia;
  Eigen::Matrix3d inertia;
  inertia << i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
  const Eigen::Quaterniond q(axes);
  const Eigen::Vector3d& d = principal.eigenvalues();
  return fmt::format(
      "<inertial pos='{}' mass='{:.17g}' quat='{:.17g} {:.17g} {:.17g} {:.17g}' diaginertia='{}'/>",
      text(b.com), b.mass, q.w(), q.x(), q.y(), q.z(), text({d[0], d[1], d[2]}));
}

std::string mjcf(const sim::RobotModel<double>& m, const MujocoSettings& settings) {
  std::string xml = fmt::format(
      "<mujoco><compiler angle='radian'/><option gravity='0 0 -9.81' timestep='{}' {}>"
      "<flag contact='{}'/></option><worldbody>"
      "<geom type='plane' size='0 0 1' {}/><body name='base'><freejoint/>{}",
      kControlPeriod_s, settings.option, settings.on_ground ? "enable" : "disable",
      settings.contact, inertial(m.base));
  for (int l = 0; l < kNumLegs; ++l) {
    const sim::LegModel<double>& leg = m.legs[l];
    const auto body = [&](const char* link, int joint, const sim::Vec3<double>& at,
                          const sim::Body<double>& b) {
      const double sign = leg.sign[static_cast<std::size_t>(joint)];
      return fmt::format(
          "<body name='{}{}' pos='{}'><joint axis='{}' armature='{:.17g}' "
          "frictionloss='{:.17g}'/>{}",
          link, l, text(at),
          text(joint == 0 ? sim::Vec3<double>{sign, 0, 0} : sim::Vec3<double>{0, sign, 0}),
          m.rotor_inertia[3 * l + joint], m.friction_nm[3 * l + joint], inertial(b));
    };
    xml += body("hip", 0, leg.haa, leg.hip) + body("thigh", 1, leg.hfe, leg.thigh) +
           body("shank", 2, leg.kfe, leg.shank) +
           fmt::format("<geom type='sphere' size='{}' pos='{}' {} mass='0'/>", m.foot_radius_m,
                       text(leg.foot), settings.contact) +
           "</body></body></body>";
  }
  return xml + "</body></worldbody></mujoco>";
}

}  // namespace

MujocoRobot::MujocoRobot(const sim::RobotModel<double>& robot, const MujocoSettings& settings) {
  const std::string xml = mjcf(robot, settings);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[500] = "";
  model_.reset(mj_loadXML("robot.xml", files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model_) throw std::runtime_error(fmt::format("MuJoCo: {}", error));
  data_.reset(mj_makeData(model_.get()));
}

void MujocoRobot::set(const sim::RigidState<double>& x) {
  const sim::Quaternion<double>& o = x.orientation;
  const double position[7] = {x.position.x, x.position.y, x.position.z, o.w, o.x, o.y, o.z};
  const double velocity[6] = {x.velocity.x,         x.velocity.y,         x.velocity.z,
                              x.angular_velocity.x, x.angular_velocity.y, x.angular_velocity.z};
  std::copy_n(position, 7, data_->qpos);
  std::copy_n(velocity, 6, data_->qvel);
  std::copy_n(x.q.begin(), kNumJoints, data_->qpos + 7);
  std::copy_n(x.qd.begin(), kNumJoints, data_->qvel + 6);
}

sim::RigidState<double> MujocoRobot::state() const {
  const double *p = data_->qpos, *v = data_->qvel;
  sim::RigidState<double> x;
  x.position = {p[0], p[1], p[2]};
  x.orientation = {p[3], p[4], p[5], p[6]};
  x.velocity = {v[0], v[1], v[2]};
  x.angular_velocity = {v[3], v[4], v[5]};
  std::copy_n(p + 7, kNumJoints, x.q.begin());
  std::copy_n(v + 6, kNumJoints, x.qd.begin());
  return x;
}

void MujocoRobot::apply(const JointArray<double>& torque_nm) {
  std::copy_n(torque_nm.begin(), kNumJoints, data_->qfrc_applied + 6);
}

}  // namespace sandrunner::bench
