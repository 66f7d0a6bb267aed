// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/mujoco_robot.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <cstring>
#include <stdexcept>

#include "rt/core/joint_pd.h"
#include "tools/bench/trotting_robots.h"

namespace sandrunner::bench {
namespace {

using sim::Body;

using sim::RobotModel;
using sim::Sym3;
using sim::Vec3;

std::string text(const Vec3<double>& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x, v.y, v.z);
}

std::string inertial(const Body<double>& b) {
  const Sym3<double>& i = b.inertia;
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

// Inertia and joints as ours; a ball at each foot and a plane are all that can touch.
std::string mjcf(const RobotModel<double>& m, MujocoSolver solver) {
  std::string xml = fmt::format(
      "<mujoco><compiler angle='radian'/><option timestep='{}'{}/><worldbody>"
      "<geom type='plane' size='0 0 1' friction='0.8' condim='3'/><body name='base'><freejoint/>{}",
      kControlPeriod_s,
      solver == MujocoSolver::kFastest ? " solver='PGS' cone='elliptic' iterations='1'" : "",
      inertial(m.base));
  for (int l = 0; l < kNumLegs; ++l) {
    const sim::LegModel<double>& leg = m.legs[l];
    const auto body = [&](int joint, const Vec3<double>& at, const char* axis,
                          const Body<double>& b) {
      return fmt::format("<body pos='{}'><joint axis='{}' armature='{:.17g}'/>{}", text(at), axis,
                         m.rotor_inertia[3 * l + joint], inertial(b));
    };
    xml += body(0, leg.haa, "1 0 0", leg.hip) + body(1, leg.hfe, "0 1 0", leg.thigh) +
           body(2, leg.kfe, "0 1 0", leg.shank) +
           fmt::format(
               "<geom type='sphere' size='{}' pos='{}' friction='0.8' condim='3' mass='0'/>"
               "</body></body></body>",
               m.foot_radius_m, text(leg.foot));
  }
  return xml + "</body></worldbody></mujoco>";
}

}  // namespace

struct MujocoRobot::Simulation {
  mjModel* model = nullptr;
  mjData* data = nullptr;
  JointArray<double> nominal_rad{};
  double contacts = 0.0;
  double steps = 0.0;

  Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  ~Simulation() {
    if (data != nullptr) mj_deleteData(data);
    if (model != nullptr) mj_deleteModel(model);
  }
};

MujocoRobot::MujocoRobot(const sim::Robot& robot, MujocoSolver solver)
    : simulation_(std::make_unique<Simulation>()) {
  const std::string xml = mjcf(robot.model, solver);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[500] = "";
  Simulation& s = *simulation_;
  s.model = mj_loadXML("robot.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (s.model == nullptr) throw std::runtime_error(fmt::format("MuJoCo: {}", error));
  s.data = mj_makeData(s.model);
  s.nominal_rad = robot.nominal_rad;
  s.data->qpos[2] = robot.nominal_height_m;
  for (int j = 0; j < kNumJoints; ++j) s.data->qpos[7 + j] = robot.nominal_rad[j];
}

MujocoRobot::~MujocoRobot() = default;

void MujocoRobot::advance(int steps) {
  Simulation& s = *simulation_;
  mjData& d = *s.data;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < kNumJoints; ++j) {
      d.qfrc_applied[6 + j] = joint_torque<double>(d.qpos[7 + j], d.qvel[6 + j], s.nominal_rad[j],
                                                   0.0, kTrotKp, kTrotKd, 0.0);
    }
    mj_step(s.model, s.data);
    s.contacts += d.ncon;
  }
  s.steps += steps;
}

double MujocoRobot::mean_contacts() const { return simulation_->contacts / simulation_->steps; }
double MujocoRobot::height_m() const { return simulation_->data->qpos[2]; }

std::string MujocoRobot::description() const {
  const mjOption& o = simulation_->model->opt;
  const char* const solvers[] = {"PGS", "CG", "Newton"};
  const char* const cones[] = {"pyramidal", "elliptic"};
  const char* const integrators[] = {"Euler", "RK4", "implicit"};
  return fmt::format(
      "MuJoCo {}, mj_step, {} solver, at most {} iterations, tolerance {:g}, {} cone, {} "
      "integrator, "
      "{:g} ms, double precision; standing on a plane on 4 ball feet, PD {}/{}",
      mj_versionString(), solvers[o.solver], o.iterations, o.tolerance, cones[o.cone],
      integrators[o.integrator], 1e3 * o.timestep, kTrotKp, kTrotKd);
}

}  // namespace sandrunner::bench
