// SPDX-License-Identifier: BSD-3-Clause
// One foot on granular ground, moved by a test.
#pragma once

#include <cmath>
#include <cstdint>

#include "sim/ground/ground.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {

inline constexpr double kFootRadius_m = 0.0295, kFootWidth_m = 2.0 * kFootRadius_m;
inline constexpr double kDt_s = 0.25e-3;

inline FootProfile<double> tyre() {
  return fit_foot_profile(FootShape::kTyre, kFootRadius_m, 0.025, 4.0);
}

/// Where the deepest point is and how it moves; z and v positive down.
struct Point {
  double x = 0.0, y = 0.0, z = 0.0, vx = 0.0, vy = 0.0, v = 0.0;
};

/// One foot on one ground, step by step.
struct Foot {
  explicit Foot(const GroundParameters& p) : ground(derive_ground(p, profile, kFootRadius_m)) {}
  FootForce<double> step(const Point& p) {
    return foot_force(ground, profile, {p.x, p.y, p.z, p.v, p.vx, p.vy}, 1.0 / kDt_s, contact);
  }
  /// Moves in a straight line at constant speed to `to` in `steps` steps; the last force.
  FootForce<double> move(Point& at, const Point& to, int steps) {
    at.vx = (to.x - at.x) / (steps * kDt_s);
    at.vy = (to.y - at.y) / (steps * kDt_s);
    at.v = (to.z - at.z) / (steps * kDt_s);
    FootForce<double> f;
    for (int i = 0; i < steps; ++i) {
      at.x += at.vx * kDt_s;
      at.y += at.vy * kDt_s;
      at.z += at.v * kDt_s;
      f = step(at);
    }
    return f;
  }
  double quasistatic(double z) const { return quasistatic_force(ground, profile, z); }

  FootProfile<double> profile = tyre();
  Ground<double> ground;
  FootContact<double> contact;
};

/// Smooth random motion: in and out of the ground, sideways up to some centimetres.
class RandomMotion {
 public:
  RandomMotion(std::uint64_t seed, double centre_m, double amplitude_m, double sideways_m)
      : draw_(seed), centre_(centre_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double size = axis == 2 ? amplitude_m : sideways_m;
      for (int i = 0; i < kWaves; ++i) {
        waves_[axis][i] = {draw_(0.2, 1.0) * size / kWaves * 2.0, draw_(3.0, 80.0),
                           draw_(0.0, 6.3)};
      }
    }
  }
  Point at(double t) const {
    double value[3] = {}, rate[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
      for (const Wave& w : waves_[axis]) {
        value[axis] += w.amplitude * std::sin(w.rate * t + w.phase);
        rate[axis] += w.amplitude * w.rate * std::cos(w.rate * t + w.phase);
      }
    }
    return {value[0], value[1], centre_ + value[2], rate[0], rate[1], rate[2]};
  }

 private:
  static constexpr int kWaves = 4;
  struct Wave {
    double amplitude, rate, phase;
  };
  Draw draw_;
  double centre_;
  Wave waves_[3][kWaves];
};

/// Any soil, with each effect on or off.
inline GroundParameters random_ground(Draw& draw) {
  GroundParameters p;
  p.sigma_flat_npm3 = draw(0.5e6, 10e6);
  p.sigma_cone_npm3 = draw(0.1e6, 0.6e6);
  p.friction = draw(0.3, 1.0);
  p.recruitment = draw(1.5, 2.5);
  p.cone_angle_rad = draw(0.95, 1.15);
  p.crater_angle_rad = draw(0.5, 0.8);
  p.crater_radius_m = draw(0.03, 0.06);
  const auto coin = [&] { return draw(0.0, 1.0) < 0.75; };
  p.inertial_drag = coin();
  p.added_mass = coin();
  p.plastic_memory = coin();
  p.healing = coin();
  p.filter = coin();
  p.stroke_resistance = coin();
  p.gated_friction = !coin();
  return p;
}

}  // namespace sandrunner::sim
