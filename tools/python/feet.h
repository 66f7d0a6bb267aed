// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/ground/terrain.h"

namespace sandrunner::python {

/// Force of the ground on a foot's deepest point; the ground lies flat at z = 0.
struct FootForce {
  double normal = 0.0;                    ///< along +z, N; < 0: mud holds the foot back
  double raw = 0.0;                       ///< before the filter of the granular law, N
  double friction_bound = 0.0;            ///< largest tangential force, N
  double stroke_x = 0.0, stroke_y = 0.0;  ///< of the crater's wall, N
};

/// A foot: a ball; of a width, a tyre that lies on its side; of a length too, a flat sole.
struct FootSize {
  double radius_m, width_m, length_m;
  int patches;  ///< that bear equal shares
};

/// The contact law of one kind of foot, for a simulator that is not ours.
class Feet {
 public:
  /// `ground`: a preset or terrain file; `settings`: PATH=VALUE of its table. Throws InputError,
  /// also for hard ground, springs that couple the feet of a robot, and ground that is not level.
  Feet(const std::string& ground, const std::vector<std::string>& settings, const FootSize& size);

  /// One time step of `count` feet or patches of feet, whose deepest points are at `position` (m)
  /// and move with `velocity` (m/s), three numbers each.
  void step(std::size_t count, const double* position, const double* velocity, double step_s,
            sim::FootContact<double>* contacts, FootForce* forces) const noexcept;

 private:
  sim::FootProfile<double> foot_;
  sim::Terrain<double> terrain_;
};

}  // namespace sandrunner::python
