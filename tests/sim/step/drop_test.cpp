// SPDX-License-Identifier: BSD-3-Clause
// A point mass of 5 kg that falls on one foot: the granular law in time, against an independent
// simulation of the same model (semi-implicit Euler, 2 s). The figures follow from the explicit
// reading of the added mass (acceleration by backward difference): at 0.5 and 1 ms, where it begins
// to matter, another reading gives other depths.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/ground/granular.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

constexpr double kMass_kg = 5.0;
constexpr double kFootRadius_m = 0.0295;

struct Drop {
  double max_depth_m = 0.0, final_depth_m = 0.0, peak_force_n = 0.0;
  // Over the last second.
  double mean_force_n = 0.0, force_deviation_n = 0.0, creep_mps = 0.0;
};

struct DropSettings {
  double sigma_flat_mnpm3, sigma_cone_mnpm3;
  double centre_height_m;
  bool quasistatic = false;
  bool filter = true;
  double dt_s = 0.25e-3;
};

Drop drop(const DropSettings& s) {
  GroundParameters parameters;
  parameters.sigma_flat_npm3 = 1e6 * s.sigma_flat_mnpm3;
  parameters.sigma_cone_npm3 = 1e6 * s.sigma_cone_mnpm3;
  parameters.inertial_drag = parameters.added_mass = !s.quasistatic;
  parameters.filter = s.filter;
  const FootProfile<double> foot = fit_foot_profile(FootShape::kTyre, kFootRadius_m, 0.025, 4.0);
  Ground<double> ground = derive_ground(parameters, foot, kFootRadius_m);
  if (s.filter) ground.filter_step = 100.0 * s.dt_s;  // c_r = 100/f_sim at this rate
  Drop d;
  FootContact<double> contact;
  double z = kFootRadius_m - s.centre_height_m, v = 0.0;
  const int steps = static_cast<int>(std::lround(2.0 / s.dt_s)), half = steps / 2;
  double sum = 0.0, square = 0.0, first = 0.0, last = 0.0;
  const int window = steps / 20;  // 0.1 s: means over it do not see the limit cycle
  for (int i = 0; i < steps; ++i) {
    const double force =
        granular_step(ground, foot, 0.0, 0.0, z, v, 0.0, 0.0, 1.0 / s.dt_s, contact).normal;
    EXPECT_GE(force, 0.0);
    d.peak_force_n = std::fmax(d.peak_force_n, force);
    if (i >= half) {
      sum += force;
      square += force * force;
      if (i < half + window) first += z / window;
      if (i >= steps - window) last += z / window;
    }
    v += s.dt_s * (kGravity_mps2 - force / kMass_kg);
    z += s.dt_s * v;
    d.max_depth_m = std::fmax(d.max_depth_m, z);
  }
  const int n = steps - half;
  d.final_depth_m = z;
  d.mean_force_n = sum / n;
  d.force_deviation_n = std::sqrt(square / n - d.mean_force_n * d.mean_force_n);
  d.creep_mps = (last - first) / 0.9;
  return d;
}

struct Row {
  double sigma_flat, sigma_cone;  // MN/m^3
  double low, high, low_quasi,
      high_quasi;  // greatest depth, mm: H = 0.05 and 0.25 m, full and quasistatic
  double peak_n;   // H = 0.25 m, full
};
constexpr Row kRows[] = {{1, .15, 78.7, 144.5, 87.9, 174.0, 342},
                         {1, .6, 36.8, 71.3, 41.7, 86.2, 343},
                         {5, .4, 21.4, 59.1, 25.1, 76.1, 362},
                         {10, .15, 14.5, 44.4, 16.4, 61.3, 391},
                         {10, .6, 14.0, 38.3, 15.8, 50.0, 394}};

TEST(DropTest, DepthsAndPeakForcesMatchTheReference) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(testing::Message() << row.sigma_flat << " " << row.sigma_cone);
    const auto check = [&](double height_m, bool quasistatic, double expected_mm) {
      const Drop d = drop({row.sigma_flat, row.sigma_cone, height_m, quasistatic});
      EXPECT_NEAR(1e3 * d.max_depth_m, expected_mm, 0.01 * expected_mm);
      // Afterwards it rests within the plastic tolerance of the greatest depth.
      EXPECT_NEAR(1e3 * d.final_depth_m, 1e3 * d.max_depth_m, 0.25);
      EXPECT_NEAR(d.mean_force_n, kMass_kg * kGravity_mps2, 0.01 * kMass_kg * kGravity_mps2);
      EXPECT_LT(std::fabs(d.creep_mps), 0.05e-3);
      return d;
    };
    check(0.05, false, row.low);
    const Drop high = check(0.25, false, row.high);
    EXPECT_NEAR(high.peak_force_n, row.peak_n, 0.01 * row.peak_n);
    check(0.05, true, row.low_quasi);
    check(0.25, true, row.high_quasi);
  }
}

TEST(DropTest, DepthDependsOnTheTimeStepAsTheReferenceDoes) {
  const auto depth_mm = [](int row, double dt_s) {
    return 1e3 * drop({kRows[row].sigma_flat, kRows[row].sigma_cone, 0.25, false, true, dt_s})
                     .max_depth_m;
  };
  const struct {
    double dt_s, soft, middle, stiff;
  } reference[] = {{0.1e-3, 144.57, 59.13, 38.39},
                   {0.25e-3, 144.47, 59.06, 38.33},
                   {0.5e-3, 144.28, 59.73, 46.16},
                   {1e-3, 154.8, 81.7, 65.9}};
  for (const auto& r : reference) {
    SCOPED_TRACE(r.dt_s);
    EXPECT_NEAR(depth_mm(0, r.dt_s), r.soft, 0.1);
    EXPECT_NEAR(depth_mm(2, r.dt_s), r.middle, 0.1);
    EXPECT_NEAR(depth_mm(4, r.dt_s), r.stiff, 0.1);
  }
}

TEST(DropTest, FilterQuietensTheForceAtRest) {
  EXPECT_NEAR(drop({1, .15, 0.25, false, false}).force_deviation_n, 79.9, 4.0);
  EXPECT_NEAR(drop({1, .15, 0.25}).force_deviation_n, 34.8, 3.5);
  EXPECT_NEAR(drop({10, .6, 0.25, false, false}).force_deviation_n, 124.0, 6.0);
  EXPECT_NEAR(drop({10, .6, 0.25}).force_deviation_n, 78.0, 8.0);
}

TEST(DropTest, SlowLoadingSinksToTheStaticDepth) {
  // Static sinkage of 5 kg. The mass is lowered: a damper in parallel with the ground, heavy enough
  // that inertia and drag do not count, leaves F_p(z) = m g.
  const double reference_mm[] = {32.9, 16.2, 6.7, 4.0, 4.0};
  for (int i = 0; i < 5; ++i) {
    GroundParameters parameters;
    parameters.sigma_flat_npm3 = 1e6 * kRows[i].sigma_flat;
    parameters.sigma_cone_npm3 = 1e6 * kRows[i].sigma_cone;
    const FootProfile<double> foot = fit_foot_profile(FootShape::kTyre, kFootRadius_m, 0.025, 4.0);
    const Ground<double> ground = derive_ground(parameters, foot, kFootRadius_m);
    FootContact<double> contact;
    const double dt_s = 0.25e-3;
    double z = -0.001, v = 0.0;
    for (int n = 0; n < 80000; ++n) {
      const double force =
          granular_step(ground, foot, 0.0, 0.0, z, v, 0.0, 0.0, 1.0 / dt_s, contact).normal;
      v = (v + dt_s * (kGravity_mps2 - force / kMass_kg)) / (1.0 + dt_s * 200.0);
      z += dt_s * v;
    }
    EXPECT_NEAR(1e3 * z, reference_mm[i], 0.1) << i;
  }
}

}  // namespace
}  // namespace sandrunner::sim
