// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/ground/height_grid.h"
#include "sim/robot/clearance.h"

namespace sandrunner::sim {

/// Height of the base origin, m, of a robot that stands square on a shape (square_on()) at the
/// world's origin with joints at `q_rad`: its lowest part is `above_m` over the surface, along the
/// normal of the plane. Real: float or double, of the shape.
template <typename Real>
double standing_height(const RobotModel<double>& model, const JointArray<double>& q_rad,
                       const Shape<Real>& shape, const Relief<Real>& relief, double above_m) {
  const Mat3<Real> r = rotation_matrix(square_on(shape));
  const double lowest = lowest_clearance(model, q_rad, [&](double ahead_m, double left_m) {
    Vec3<Real> p = r * Vec3<Real>{static_cast<Real>(ahead_m), static_cast<Real>(left_m), Real(0.0)};
    p.z = surface_at(shape, relief, p.x, p.y).height;
    return static_cast<double>(shape.over_plane(p) / shape.stretch);
  });
  return (above_m - lowest) * static_cast<double>(shape.stretch);
}

}  // namespace sandrunner::sim
