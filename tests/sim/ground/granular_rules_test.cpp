// SPDX-License-Identifier: BSD-3-Clause
// The granular law, which the simulator writes without branches, against a plain reading of the
// paper's rules with them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/ground/granular_foot.h"

namespace sandrunner::sim {
namespace {

/// The rules as one reads them (paper S11, S13, S15, S16, eqs. 1 and 2; constants and order of the
/// authors' code).
class PlainReading {
 public:
  PlainReading(const GroundParameters& p, const FootProfile<double>& foot) : p_(p), foot_(foot) {
    GroundParameters all = p;
    all.added_mass = all.inertial_drag = true;
    ground_ = derive_ground(all, foot, kFootRadius_m);
  }
  struct Force {
    double raw = 0.0, normal = 0.0, friction_bound = 0.0, stroke_x = 0.0, stroke_y = 0.0;
  };
  Force step(const Point& q) {
    const double v_before = v_before_;
    v_before_ = q.v;
    if (q.z < 0.0) {
      touching_ = false;
      return {};
    }
    if (!touching_) {
      touching_ = true;
      z_mem_ = 0.0;
      d_max_ = flat_at_restart_ = tau_ = ema_ = 0.0;
      ploughing_ = false;
    }
    double p0, p1;
    foot_.integrals(q.z, p0, p1);
    const Cone<double> cone = cone_integrals(ground_, q.z, p0, p1);
    const double f_p =
        p_.sigma_flat_npm3 * cone.flat_integral + p_.sigma_cone_npm3 * cone.cone_integral;
    const double recruited = p_.mass_scaling * p_.packing * p_.grain_density_kgpm3 * p_.recruitment;
    const double k = p_.recruitment / std::tan(p_.cone_angle_rad);
    const double flat_radius = std::fmax(foot_.hydraulic_radius(q.z) - k * q.z, 0.0);
    const bool pushes = q.v > 0.0 && (!p_.plastic_memory || q.z >= z_mem_ - p_.plastic_tolerance_m);
    if (q.z > z_mem_) {
      z_mem_ = q.z;
      x_mem_ = q.x;
      y_mem_ = q.y;
      d_max_ = 0.0;
    }
    const double d = std::hypot(q.x - x_mem_, q.y - y_mem_);
    if (d > p_.crater_radius_m) {
      const double overlap = overlap_with(d, z_mem_, q.z);
      if (overlap > 0.0 && !ploughing_ && p_.stroke_resistance) {
        ploughing_ = true;
        x_crater_ = x_mem_;
        y_crater_ = y_mem_;
        z_crater_ = z_mem_;
        s_max_ = -1.0;
        flat_at_restart_ = cone.flat_integral;
        tau_ = 0.0;
      }
      if (d > d_max_ && p_.healing) {
        const double increment = d - std::fmax(d_max_, p_.crater_radius_m);
        z_mem_ = std::fmax(z_mem_ - std::tan(p_.crater_angle_rad) * increment, 0.0);
      }
    }
    d_max_ = std::fmax(d_max_, d);

    Force f;
    if (pushes) {
      f.raw = f_p;
      if (p_.inertial_drag)
        f.raw += p_.drag * recruited * std::numbers::pi * flat_radius * flat_radius * q.v * q.v;
      if (p_.added_mass) {
        f.raw += recruited * std::fmax(cone.flat_integral - flat_at_restart_, 0.0) *
                 (q.v - v_before) / kDt_s;
      }
    }
    if (q.v * v_before < 0.0 && p_.filter) tau_ = std::fmin(1.0, tau_ + 0.025);
    ema_ = std::fmax((1.0 - 0.8 * tau_) * f.raw + 0.8 * tau_ * ema_, 0.0);
    f.normal = ema_;
    if (!p_.gated_friction || pushes) f.friction_bound = p_.friction * f_p;
    if (ploughing_) {
      const double sx = q.x - x_crater_, sy = q.y - y_crater_, s = std::hypot(sx, sy);
      const double overlap = overlap_with(s, z_crater_, q.z);
      if (overlap > 0.0 && s > s_max_ && q.z > kFootRadius_m && s > 1e-6) {
        const double ex = sx / s, ey = sy / s;
        const double spring =
            p_.stroke_stiffness_npm * (overlap + p_.stroke_depth_scaling * (q.z - kFootRadius_m));
        const double magnitude =
            std::fmax(spring, 0.0) + p_.stroke_damping_nspm * std::fmax(q.vx * ex + q.vy * ey, 0.0);
        f.stroke_x = -magnitude * ex;
        f.stroke_y = -magnitude * ey;
      }
      s_max_ = std::fmax(s_max_, s);
    }
    return f;
  }

 private:
  double overlap_with(double d, double z_max, double z) const {  // eq. 1
    const double g = p_.crater_angle_rad;
    return d + kFootRadius_m / std::sin(g) - p_.crater_radius_m -
           (z_max - z + kFootRadius_m) / std::tan(g);
  }
  GroundParameters p_;
  FootProfile<double> foot_;
  Ground<double> ground_;
  bool touching_ = false, ploughing_ = false;
  double v_before_ = 0.0, z_mem_ = 0.0, x_mem_ = 0.0, y_mem_ = 0.0, d_max_ = 0.0,
         flat_at_restart_ = 0.0, tau_ = 0.0, ema_ = 0.0, x_crater_ = 0.0, y_crater_ = 0.0,
         z_crater_ = 0.0, s_max_ = 0.0;
};

TEST(GranularTest, FollowsThePlainReadingOfTheRules) {
  int forces = 0, strokes = 0, restarts = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Draw draw(1000 + seed);
    const GroundParameters p = random_ground(draw);
    Foot foot(p);
    PlainReading plain(p, foot.profile);
    const RandomMotion motion(seed, draw(0.0, 0.06), 0.08, draw(0.0, 0.25));
    for (int i = 0; i < 4000; ++i) {
      const Point q = motion.at(i * kDt_s);
      const FootForce<double> f = foot.step(q);
      const PlainReading::Force e = plain.step(q);
      const double tolerance = 1e-9 * (1.0 + std::fabs(e.raw));
      ASSERT_NEAR(f.raw, e.raw, tolerance) << "seed " << seed << " step " << i;
      ASSERT_NEAR(f.normal, e.normal, tolerance) << "seed " << seed << " step " << i;
      ASSERT_NEAR(f.friction_bound, e.friction_bound, tolerance)
          << "seed " << seed << " step " << i;
      ASSERT_NEAR(-f.stroke * f.direction_x, e.stroke_x, 1e-9) << "seed " << seed << " step " << i;
      ASSERT_NEAR(-f.stroke * f.direction_y, e.stroke_y, 1e-9) << "seed " << seed << " step " << i;
      forces += f.normal > 0.0;
      strokes += f.stroke > 0.0;
      restarts += foot.contact.restart_flat > 0.0;
    }
  }
  // Enough of everything came up.
  EXPECT_GT(forces, 20000);
  EXPECT_GT(strokes, 2000);
  EXPECT_GT(restarts, 2000);
}

}  // namespace
}  // namespace sandrunner::sim
