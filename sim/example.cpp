// SPDX-License-Identifier: BSD-3-Clause
// MuJoCo's robot on our ground: MuJoCo moves the robot, sim/ground gives the forces on its feet.
#include <mujoco/mujoco.h>

#include <cstdio>

#include "sim/ground/granular.h"
namespace sim = sandrunner::sim;

// A ball foot of 3 cm on dry sand, and what the contact of each foot remembers.
const auto foot = sim::fit_foot_profile(sim::FootShape::kSphere, 0.03, 0.0, 3.24);
const auto sand = sim::derive_law(sim::GranularParameters{}, foot, 0.03);
sim::FootContact<double> contacts[4];

// MuJoCo calls this in each step of 0.25 ms. The friction is full from 0.05 m/s on.
void add_sand(const mjModel* m, mjData* d) {
  for (int i = 0; i < 4; ++i) {
    const mjtNum* at = d->site_xpos + 3 * i;
    mjtNum v[6];  // angular, then linear velocity
    mj_objectVelocity(m, d, mjOBJ_SITE, i, v, 0);
    const sim::FootMotion<double> motion{at[0], at[1], 0.03 - at[2], -v[5], v[3], v[4]};
    const auto f = sand.step(foot, 0.8, motion, 4000.0, contacts[i]);
    const double friction = f.friction_bound / mju_max(mju_norm(v + 3, 2), 0.05);
    const mjtNum force[6] = {-friction * v[3] - f.stroke * f.direction_x,
                             -friction * v[4] - f.stroke * f.direction_y, f.normal};
    mj_applyFT(m, d, force, force + 3, at, m->site_bodyid[i], d->qfrc_passive);
  }
}

int main(int, char** argv) {
  char error[200] = "";
  mjModel* m = mj_loadXML(argv[1], nullptr, error, sizeof error);
  if (m == nullptr) return std::fprintf(stderr, "%s\n", error), 2;
  mjData* d = mj_makeData(m);
  mjcb_passive = add_sand;
  // Gravity grows over two seconds, so nothing but the weight presses the feet into the sand.
  for (; d->time < 2.5; mj_step(m, d)) m->opt.gravity[2] = -9.81 * mju_min(d->time / 2.0, 1.0);
  // The feet rest about as deep as the law says: the sand carries the weight there.
  const double depth = 0.03 - d->site_xpos[2], weight = 9.81 * mj_getTotalmass(m);
  const double share = 4.0 * quasistatic_force(sand, foot, depth) / weight;
  std::printf("%.1f mm deep, where the sand carries %.2f of the weight\n", 1e3 * depth, share);
  mj_deleteData(d);
  mj_deleteModel(m);
  return share > 0.9 && share < 1.1 ? 0 : 1;
}
