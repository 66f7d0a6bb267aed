// SPDX-License-Identifier: BSD-3-Clause
// The cone model's geometry: the foot's profile against quadrature, and the reference figures of
// Aguilar & Goldman's closed form with a constant and with the tyre's hydraulic radius (nu = 2,
// theta = 60 deg, c_g = 2.7, phi = 0.57, rho = 1000 kg/m^3, c_d = 17.2).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/ground/foot_profile.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

using std::numbers::pi;
constexpr double kTyreRadius_m = 0.0295;
constexpr double kTyreWidth_m = 0.025;
/// 4 A/P of the tyre's whole patch, 2 r by its width; the table prints 0.035119.
constexpr double kBuriedRadius_m = 4.0 * 0.059 * 0.025 / (2.0 * (0.059 + 0.025));

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

/// `value` prints as `printed` when rounded to its `digits` (1 unit of the last one is allowed
/// for).
void expect_digits(double value, double printed, int digits, const char* what) {
  if (printed == 0.0) {
    EXPECT_EQ(value, 0.0) << what;
    return;
  }
  const double unit = std::pow(10.0, std::floor(std::log10(printed)) - (digits - 1));
  EXPECT_NEAR(value, printed, unit) << what;
}

TEST(ConeTest, ConstantRadiusMatchesTheClosedForm) {
  struct Row {
    double radius, z, flat_area, flat_integral, cone_area, cone_integral, mass, force1, force2,
        drag;
  };
  const Row rows[] = {
      {0.0295, .005, 1.768549e-3, 1.116903e-5, 1.930844e-3, 5.001642e-6, .03438, 11.919, 114.691,
       93.630},
      {0.0295, .010, 1.012567e-3, 1.803456e-5, 3.442808e-3, 1.861031e-5, .05551, 20.826, 191.512,
       53.607},
      {0.0295, .020, 1.289206e-4, 2.304386e-5, 5.210101e-3, 6.327112e-5, .07093, 32.535, 268.401,
       6.825},
      {0.0295, .100, 0, 2.328227e-5, 5.467942e-3, 5.002297e-4, .07166, 98.317, 532.960, 0},
      {kBuriedRadius_m, .010, 1.745598e-3, 2.740324e-5, 4.258154e-3, 2.268704e-5, .08435, 30.806,
       287.645, 92.415},
      {kBuriedRadius_m, .100, 0, 3.928144e-5, 7.749351e-3, 6.963722e-4, .12091, 143.737, 810.638,
       0},
      {0.0381, .010, 2.215016e-3, 3.317879e-5, 4.690702e-3, 2.484978e-5, .10212, 36.906, 346.698,
       117.266},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(testing::Message() << "r_h " << row.radius << " z " << row.z);
    const FootProfile<double> foot = fit_foot_profile(FootShape::kDisc, row.radius, 0.0, 2.0);
    const ConeFigures f = figures({}, foot, row.z);
    EXPECT_EQ(f.radius, row.radius);
    expect_digits(f.flat_area, row.flat_area, 7, "A_flat");
    expect_digits(f.flat_integral, row.flat_integral, 7, "I_flat");
    expect_digits(f.cone_area, row.cone_area, 7, "A_cone");
    expect_digits(f.cone_integral, row.cone_integral, 7, "I_cone");
    expect_digits(f.added_mass, row.mass, row.mass < 0.1 ? 4 : 5, "m_a");
    EXPECT_NEAR(f.force(1.0, 0.15), row.force1, 0.001);
    EXPECT_NEAR(f.force(10.0, 0.6), row.force2, 0.001);
    EXPECT_NEAR(f.drag, row.drag, 0.001);
  }
  // The depth at which the lower flat has vanished.
  const FootProfile<double> foot = fit_foot_profile(FootShape::kDisc, 0.0295, 0.0, 2.0);
  const Ground<double> g = derive_ground({}, foot, kTyreRadius_m);
  EXPECT_NEAR(g.full_depth, .02555, 5e-6);
  const ConeFigures f = figures({}, foot, g.full_depth);
  EXPECT_NEAR(f.flat_area, 0.0, 1e-18);
  expect_digits(f.flat_integral, 2.328227e-5, 7, "I_flat");
  expect_digits(f.cone_integral, 9.3129e-5, 5, "I_cone");
  EXPECT_NEAR(f.force(1.0, 0.15), 37.252, 0.001);
  EXPECT_NEAR(f.force(10.0, 0.6), 288.700, 0.001);
}

TEST(ConeTest, TyreMatchesTheReferenceTable) {
  struct Row {
    double z, radius, flat_area, cone_area, flat_integral, cone_integral, force1, force2, force3,
        mass, drag;
  };
  const Row rows[] = {
      {.001, .018930, 9.9261e-4, 2.6630e-4, 6.1436e-7, 1.1510e-7, 0.632, 0.672, 6.213, .00189,
       52.55},
      {.002, .023034, 1.3493e-3, 6.3495e-4, 1.80785e-6, 5.6199e-7, 1.892, 2.089, 18.416, .00556,
       71.43},
      {.005, .028397, 1.6080e-3, 1.8508e-3, 6.41833e-6, 4.27656e-6, 7.060, 8.557, 66.749, .01976,
       85.13},
      {.010, .031955, 1.3085e-3, 3.7991e-3, 1.38740e-5, 1.85001e-5, 16.649, 23.124, 149.84, .04270,
       69.27},
      {.020, .034541, 4.1163e-4, 6.6729e-3, 2.23209e-5, 7.21907e-5, 33.149, 58.416, 266.52, .06870,
       21.79},
      {.030, .035119, 7.2e-7, 7.7479e-3, 2.37952e-5, 1.45952e-4, 45.688, 96.771, 325.52, .07324,
       0.04},
      {.050, .035119, 0, 7.7494e-3, 2.37953e-5, 3.00939e-4, 68.936, 174.27, 418.52, .07324, 0},
      {.100, .035119, 0, 7.7494e-3, 2.37953e-5, 6.88406e-4, 127.06, 368.00, 651.00, .07324, 0},
  };
  const FootProfile<double> foot =
      fit_foot_profile(FootShape::kTyre, kTyreRadius_m, kTyreWidth_m, 4.0);
  EXPECT_NEAR(derive_ground({}, foot, kTyreRadius_m).full_depth, 0.03042, 1e-5);
  for (const Row& row : rows) {
    SCOPED_TRACE(testing::Message() << "z " << row.z);
    const ConeFigures f = figures({}, foot, row.z);
    EXPECT_NEAR(f.radius, row.radius, 1e-6);
    expect_digits(f.flat_area, row.flat_area, row.z == .030 ? 2 : 5, "A_flat");
    expect_digits(f.cone_area, row.cone_area, 5, "A_cone");
    // The table's own quadrature is 2e-5 high at the first two depths
    // (IntegralsMatchDirectQuadrature).
    EXPECT_NEAR(f.flat_integral, row.flat_integral,
                row.z < .005 ? 1.5e-11 : 1e-11 * (row.z < .01 ? 1 : 10));
    expect_digits(f.cone_integral, row.cone_integral, row.z < .005 ? 5 : 6, "I_cone");
    EXPECT_NEAR(f.force(1.0, 0.15), row.force1, row.force1 < 100 ? 0.001 : 0.01);
    EXPECT_NEAR(f.force(1.0, 0.5), row.force2, row.force2 < 100 ? 0.001 : 0.01);
    EXPECT_NEAR(f.force(10.0, 0.6), row.force3, row.force3 < 100 ? 0.001 : 0.01);
    EXPECT_NEAR(f.added_mass, row.mass, 1e-5);
    EXPECT_NEAR(f.drag, row.drag, 0.01);
  }
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
