// SPDX-License-Identifier: BSD-3-Clause
// The cone model's geometry: the foot's profile against quadrature, and the figures of
// tests/golden/cone.csv with a constant and with the tyre's hydraulic radius (nu = 2, theta = 60
// deg, c_g = 2.7, phi = 0.57, rho = 1000 kg/m^3, c_d = 17.2).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/ground/foot_profile.h"
#include "tests/sim/support.h"
#include "tests/support/csv.h"

namespace sandrunner::sim {
namespace {

using std::numbers::pi;
constexpr double kTyreRadius_m = 0.0295;
constexpr double kTyreWidth_m = 0.025;

/// r_h from the definition c_h A/P, independent of FootProfile.
double radius_by_definition(FootShape shape, double r, double width, double factor, double z) {
  const double a = z < r ? std::sqrt(z * (2.0 * r - z)) : r;
  switch (shape) {
    case FootShape::kTyre:
      return factor * (2.0 * a * width) / (2.0 * (2.0 * a + width));
    case FootShape::kSphere:
      return factor * (pi * a * a) / (2.0 * pi * a);
    case FootShape::kDisc:
      break;
  }
  return factor * (pi * r * r) / (2.0 * pi * r);
}

/// int_0^z z'^m r_h(z')^n dz' by Simpson's rule in s with z' = z s^2, which takes the root at 0
/// away.
double quadrature(FootShape shape, double factor, int m, int n, double z) {
  // Split at r, beyond which r_h is constant.
  double sum = 0.0;
  const auto part = [&](double low, double high) {
    constexpr int kPanels = 4000;
    const double h = 1.0 / kPanels;
    const auto f = [&](double s) {
      const double at = low + (high - low) * s * s;
      if (at <= 0.0) return 0.0;
      return std::pow(at, m) *
             std::pow(radius_by_definition(shape, kTyreRadius_m, kTyreWidth_m, factor, at), n) *
             2.0 * (high - low) * s;
    };
    for (int i = 0; i < kPanels; ++i) {
      sum += h / 6.0 * (f(i * h) + 4.0 * f((i + 0.5) * h) + f((i + 1) * h));
    }
  };
  part(0.0, std::fmin(z, kTyreRadius_m));
  if (z > kTyreRadius_m) part(kTyreRadius_m, z);
  return sum;
}

class ProfileTest : public testing::TestWithParam<std::pair<FootShape, double>> {};

TEST_P(ProfileTest, IntegralsMatchQuadrature) {
  const auto [shape, factor] = GetParam();
  const FootProfile<double> foot = fit_foot_profile(shape, kTyreRadius_m, kTyreWidth_m, factor);
  const FootProfile<float> narrow = convert_profile<float>(foot);
  for (const double z : {1e-6, 1e-5, 1e-4, 5e-4, 0.001, 0.002, 0.005, 0.01, 0.015, 0.02, 0.025,
                         0.0294, 0.0295, 0.031, 0.05, 0.15}) {
    const double p0_exact = quadrature(shape, factor, 0, 2, z),
                 p1_exact = quadrature(shape, factor, 1, 1, z);
    EXPECT_NEAR(foot.hydraulic_radius(z),
                radius_by_definition(shape, kTyreRadius_m, kTyreWidth_m, factor, z), 1e-15);
    double p0, p1;
    foot.integrals(z, p0, p1);
    EXPECT_NEAR(p0 / p0_exact, 1.0, 1e-6) << z;
    EXPECT_NEAR(p1 / p1_exact, 1.0, 1e-6) << z;
    float q0, q1;
    narrow.integrals(static_cast<float>(z), q0, q1);
    EXPECT_NEAR(q0 / p0_exact, 1.0, 5e-6) << z;
    EXPECT_NEAR(q1 / p1_exact, 1.0, 5e-6) << z;
  }
  double p0, p1;
  foot.integrals(0.0, p0, p1);
  EXPECT_EQ(p0, 0.0);
  EXPECT_EQ(p1, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Shapes, ProfileTest,
                         testing::Values(std::pair{FootShape::kTyre, 4.0},
                                         std::pair{FootShape::kTyre, 2.0},
                                         std::pair{FootShape::kSphere, 2.0},
                                         std::pair{FootShape::kDisc, 2.0}));

/// Everything of the cone at one depth.
struct ConeFigures {
  double radius, flat_area, cone_area, flat_integral, cone_integral, added_mass, drag;
  /// F_p, N, for stress gradients in MN/m^3.
  double force(double sigma_flat, double sigma_cone) const {
    Ground<double> g;
    g.sigma_flat = 1e6 * sigma_flat;
    g.sigma_cone = 1e6 * sigma_cone;
    return quasistatic_force(g, Cone<double>{flat_integral, cone_integral});
  }
};
ConeFigures figures(const GroundParameters& parameters, const FootProfile<double>& foot, double z) {
  const Ground<double> g = derive_ground(parameters, foot, kTyreRadius_m);
  double p0, p1;
  foot.integrals(z, p0, p1);
  const Cone<double> cone = cone_integrals(g, z, p0, p1);
  ConeFigures f;
  f.radius = foot.hydraulic_radius(z);
  f.flat_area = flat_area(g, z, f.radius);
  f.cone_area = (pi * f.radius * f.radius - f.flat_area) * g.inverse_cos;
  f.flat_integral = cone.flat_integral;
  f.cone_integral = cone.cone_integral;
  f.added_mass = g.added_mass * cone.flat_integral;
  f.drag = g.drag * f.flat_area;
  return f;
}

TEST(ConeTest, AreasIntegralsAndForcesMatchTheGoldenTable) {
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/cone.csv")) {
    const double radius = row.at("constant_radius_m");  // 0: the tyre
    SCOPED_TRACE(testing::Message() << "r_h " << radius << " z " << row.at("z_m"));
    const FootProfile<double> foot =
        radius > 0.0 ? fit_foot_profile(FootShape::kDisc, radius, 0.0, 2.0)
                     : fit_foot_profile(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0);
    const ConeFigures f = figures({}, foot, row.at("z_m"));
    const auto expect = [&](const char* name, double found, double tolerance) {
      EXPECT_NEAR(found, row.at(name), tolerance * row.at(name)) << name;
    };
    // The table has seven digits; the tyre's fitted profile is good for 1e-6 of P0 and P1.
    const double digits = 1e-6, fit = radius > 0.0 ? 1e-6 : 1e-5;
    expect("radius_m", f.radius, digits);
    // At 30 mm r_h - k z is all but gone.
    expect("flat_area_m2", f.flat_area, row.at("z_m") == 0.03 ? 1e-4 : digits);
    expect("cone_area_m2", f.cone_area, digits);
    expect("flat_integral_m3", f.flat_integral, fit);
    expect("cone_integral_m3", f.cone_integral, fit);
    expect("force_1_015_n", f.force(1.0, 0.15), fit);
    expect("force_1_05_n", f.force(1.0, 0.5), fit);
    expect("force_10_06_n", f.force(10.0, 0.6), fit);
    expect("added_mass_kg", f.added_mass, fit);
    expect("drag_ns2pm2", f.drag, row.at("z_m") == 0.03 ? 1e-4 : digits);
  }
}

TEST(ConeTest, ConeIsFullWhereItsLowerFlatHasVanished) {
  const double k = 2.0 / std::sqrt(3.0);
  const FootProfile<double> disc = fit_foot_profile(FootShape::kDisc, 0.0295, 0.0, 2.0);
  const Ground<double> g = derive_ground({}, disc, kTyreRadius_m);
  EXPECT_NEAR(g.full_depth, 0.0295 / k, 1e-12);
  const ConeFigures f = figures({}, disc, g.full_depth);
  EXPECT_NEAR(f.flat_area, 0.0, 1e-18);
  // The volume of a cone of the radius and the depth.
  EXPECT_NEAR(f.flat_integral, pi * 0.0295 * 0.0295 * g.full_depth / 3.0, 1e-12);

  const FootProfile<double> tyre =
      fit_foot_profile(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0);
  const double depth_m = derive_ground({}, tyre, kTyreRadius_m).full_depth;
  const double buried_m =
      radius_by_definition(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0, 1.0);
  EXPECT_NEAR(depth_m, buried_m / k, 1e-5);
}

TEST(ConeTest, TyreIntegralsMatchDirectQuadrature) {
  // I_flat as the integral of A_flat itself, without P0 and P1.
  const FootProfile<double> foot =
      fit_foot_profile(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0);
  const double k = 2.0 / std::sqrt(3.0);
  for (const double z : {.001, .002, .005, .02, .03}) {
    constexpr int kPanels = 20000;
    double flat = 0.0, whole = 0.0;
    for (int i = 0; i < kPanels; ++i) {  // midpoints in s, z' = z s^2
      const double s = (i + 0.5) / kPanels, at = z * s * s;
      const double r = radius_by_definition(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0, at);
      const double weight = pi * 2.0 * z * s / kPanels;
      flat += weight * std::pow(std::fmax(r - k * at, 0.0), 2);
      whole += weight * r * r;
    }
    const ConeFigures f = figures({}, foot, z);
    EXPECT_NEAR(f.flat_integral / flat, 1.0, 5e-6) << z;  // P0 and P1 to 1e-6, and they cancel
    EXPECT_NEAR(f.cone_integral / (2.0 * (whole - flat)), 1.0, 1e-5) << z;
  }
}

TEST(ConeTest, ForceIsContinuousAndMonotonicInDepth) {
  const FootProfile<double> foot =
      fit_foot_profile(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0);
  double before = 0.0;
  for (int i = 1; i <= 15000; ++i) {
    const double force = figures({}, foot, i * 1e-5).force(1.0, 0.2);
    EXPECT_GT(force, before);
    EXPECT_LT(force - before, 1e-5 * 5e3);  // no jump: the steepest slope is below 5 kN/m
    before = force;
  }
}

}  // namespace
}  // namespace sandrunner::sim
