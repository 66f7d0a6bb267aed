// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/standing_mujoco.h"

#include <fmt/format.h>

#include "rt/core/joint_pd.h"
#include "tools/bench/trotting_robots.h"

namespace sandrunner::bench {
namespace {

MujocoSettings settings(MujocoSolver solver) {
  MujocoSettings s;
  if (solver == MujocoSolver::kFastest) s.option = "solver='PGS' cone='elliptic' iterations='1'";
  return s;
}

}  // namespace

StandingMujoco::StandingMujoco(const sim::Robot& robot, MujocoSolver solver)
    : robot_(robot.model, settings(solver)), nominal_rad_(robot.nominal_rad) {
  sim::RigidState<double> stand;
  stand.position.z = robot.nominal_height_m;
  stand.q = robot.nominal_rad;
  robot_.set(stand);
}

void StandingMujoco::advance(int steps) {
  const mjData& d = *robot_.data();
  JointArray<double> torque_nm;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < kNumJoints; ++j) {
      torque_nm[j] = joint_torque<double>(d.qpos[7 + j], d.qvel[6 + j], nominal_rad_[j], 0.0,
                                          kTrotKp, kTrotKd, 0.0);
    }
    robot_.apply(torque_nm);
    robot_.step();
    contacts_ += d.ncon;
  }
  steps_ += steps;
}

std::string StandingMujoco::description() const {
  const mjOption& o = robot_.model()->opt;
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
