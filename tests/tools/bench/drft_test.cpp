// SPDX-License-Identifier: BSD-3-Clause
// DRFT's forces against the published constants, closed forms and symmetries. They show that the
// peer of the benchmark computes the whole law, not part of it.
#include "tools/bench/drft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/csv.h"

namespace sandrunner::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kArea_m2 = 2e-3, kDepth_m = 0.07;
constexpr double kRadius_m = 0.0295, kWidth_m = 0.025;
const DrftMedium kMedium{0.4e6, 1600.0, 1.1};
const DrftMedium kQuasistatic{0.4e6, 1600.0, 0.0};

sim::Mat3<double> about_y(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
}
sim::Mat3<double> about_z(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
}

/// Both sides of a thin plate tilted by beta, at the body's centre.
std::vector<SurfaceElement> plate(double beta_rad) {
  const Vector lower{std::sin(beta_rad), 0.0, -std::cos(beta_rad)};
  return {{{}, lower, kArea_m2}, {{}, -1.0 * lower, kArea_m2}};
}
/// Motion at gamma below the horizontal, toward +x.
BodyMotion motion_at(double gamma_rad, double speed_mps) {
  BodyMotion m;
  m.depth_m = kDepth_m;
  m.velocity_mps = {speed_mps * std::cos(gamma_rad), 0.0, -speed_mps * std::sin(gamma_rad)};
  return m;
}
/// The whole foot, turned and moving in any way; in the plane if `planar`.
BodyMotion any_motion(bool planar) {
  BodyMotion m;
  m.depth_m = 0.01;
  m.rotation = planar ? about_y(0.4) : about_z(0.7) * about_y(0.4);
  m.velocity_mps = {0.8, planar ? 0.0 : 0.5, -0.3};
  m.spin_radps = {planar ? 0.0 : 3.0, 9.0, planar ? 0.0 : -4.0};
  return m;
}
std::vector<SurfaceElement> whole_foot() {
  std::vector<SurfaceElement> elements = cylinder_rim(kRadius_m, kWidth_m, 40, 5);
  for (const double side : {-1.0, 1.0}) {
    const auto end = cylinder_end(kRadius_m, kWidth_m, 5, 20, side);
    elements.insert(elements.end(), end.begin(), end.end());
  }
  return elements;
}
void expect_near(const Vector& a, const Vector& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// alpha of a plate: force over zeta |z| A.
template <typename Drft>
Vector alpha(double beta_rad, double gamma_rad) {
  const Vector force =
      Drft(plate(beta_rad)).wrench(kQuasistatic, motion_at(gamma_rad, 0.3)).force_n;
  return 1.0 / (kQuasistatic.stress_npm3 * kDepth_m * kArea_m2) * force;
}

TEST(DrftTest, StressesOfAPlateMatchTheGoldenTable) {
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/rft.csv")) {
    SCOPED_TRACE(testing::PrintToString(row));
    const auto of_plate = row.at("dimensions") == 2.0 ? alpha<PlanarDrft> : alpha<SpatialDrft>;
    const Vector a = of_plate(row.at("beta_rad"), row.at("gamma_rad"));
    EXPECT_NEAR(a.x, row.at("x"), 1e-8);
    EXPECT_NEAR(a.y, 0.0, 1e-12);
    EXPECT_NEAR(a.z, row.at("z"), 1e-8);
  }
}

TEST(DrftTest, FastPlateAddsTheMomentumOfTheGrains) {
  const double speed_mps = 1.7;
  const double momentum_n = 1.1 * 1600.0 * speed_mps * speed_mps * kArea_m2;
  const BodyMotion down = motion_at(kPi / 2, speed_mps);
  EXPECT_NEAR(PlanarDrft(plate(0)).wrench(kMedium, down).force_n.z -
                  PlanarDrft(plate(0)).wrench(kQuasistatic, down).force_n.z,
              momentum_n, 1e-9);
  EXPECT_NEAR(SpatialDrft(plate(0)).wrench(kMedium, down).force_n.z -
                  SpatialDrft(plate(0)).wrench(kQuasistatic, down).force_n.z,
              momentum_n, 1e-9);
}

TEST(DrftTest, OnlyElementsThatLeadBelowTheSurfaceAct) {
  const std::vector<SurfaceElement> elements = cylinder_rim(kRadius_m, kWidth_m, 400, 1);
  BodyMotion m;
  m.velocity_mps = {0.0, 0.0, -1.0};
  const PlanarDrft planar(elements);
  const SpatialDrft spatial(elements);
  m.depth_m = -kRadius_m;  // just above the ground
  EXPECT_EQ(planar.wrench(kMedium, m).force_n.z, 0.0);
  EXPECT_EQ(spatial.wrench(kMedium, m).force_n.z, 0.0);
  m.depth_m = 0.0;  // buried to its centre, on the way up: the half below the surface trails
  m.velocity_mps.z = 1.0;
  EXPECT_EQ(planar.wrench(kMedium, m).force_n.z, 0.0);
  EXPECT_EQ(spatial.wrench(kMedium, m).force_n.z, 0.0);
  m.velocity_mps.z = 0.0;
  EXPECT_EQ(planar.wrench(kMedium, m).force_n.z, 0.0);
  EXPECT_EQ(spatial.wrench(kMedium, m).force_n.z, 0.0);
}

TEST(DrftTest, MirroredMotionGivesTheMirroredForce) {
  const std::vector<SurfaceElement> elements = whole_foot();
  BodyMotion m = any_motion(true);
  m.rotation = about_y(0.0);
  const auto check = [&](const auto& foot) {
    BodyMotion back = m;
    back.velocity_mps.x = -m.velocity_mps.x;
    back.spin_radps.y = -m.spin_radps.y;
    const Wrench a = foot.wrench(kMedium, m), b = foot.wrench(kMedium, back);
    EXPECT_LT(a.force_n.x, -1.0);
    expect_near(b.force_n, {-a.force_n.x, a.force_n.y, a.force_n.z}, 1e-9);
    EXPECT_NEAR(b.torque_nm.y, -a.torque_nm.y, 1e-9);
  };
  check(PlanarDrft(elements));
  check(SpatialDrft(elements));
}

TEST(DrftTest, TurningTheFootIsTurningItsElements) {
  std::vector<SurfaceElement> elements = whole_foot();
  for (SurfaceElement& e : elements) e.place_m.x += 0.02;  // off its centre: torques
  const auto check = [&](const auto& made, bool planar) {
    const BodyMotion m = any_motion(planar);
    std::vector<SurfaceElement> turned = elements;
    for (SurfaceElement& e : turned) {
      e.place_m = m.rotation * e.place_m;
      e.normal = m.rotation * e.normal;
    }
    BodyMotion upright = m;
    upright.rotation = BodyMotion{}.rotation;
    const Wrench a = made(elements).wrench(kMedium, m), b = made(turned).wrench(kMedium, upright);
    expect_near(a.force_n, b.force_n, 1e-9);
    expect_near(a.torque_nm, b.torque_nm, 1e-10);
    EXPECT_GT(std::fabs(a.torque_nm.y), 0.01);
  };
  check([](const auto& e) { return PlanarDrft(e); }, true);
  check([](const auto& e) { return SpatialDrft(e); }, false);
}

TEST(DrftTest, TheDirectionOnTheGroundDoesNotMatter) {
  const SpatialDrft foot(whole_foot());
  const BodyMotion m = any_motion(false);
  const sim::Mat3<double> yaw = about_z(2.1);
  BodyMotion turned = m;
  turned.rotation = yaw * m.rotation;
  turned.velocity_mps = yaw * m.velocity_mps;
  turned.spin_radps = yaw * m.spin_radps;
  const Wrench a = foot.wrench(kMedium, m), b = foot.wrench(kMedium, turned);
  expect_near(b.force_n, yaw * a.force_n, 1e-9);
  expect_near(b.torque_nm, yaw * a.torque_nm, 1e-10);
}

TEST(DrftTest, SpinningWheelIsBrakedAndPushedForward) {
  // Turning forward (about +y) and buried: the rim below goes back, the ground pushes forward.
  BodyMotion m;
  m.depth_m = 0.0;
  m.spin_radps = {0.0, 10.0, 0.0};
  // Blades, since a smooth rim has no element that leads when it turns in place.
  std::vector<SurfaceElement> blades;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2.0 * kPi * i / 12;
    const Vector normal{-std::sin(angle), 0.0, std::cos(angle)};
    const Vector place{kRadius_m * std::cos(angle), 0.0, kRadius_m * std::sin(angle)};
    blades.push_back({place, normal, 1e-4});
    blades.push_back({place, -1.0 * normal, 1e-4});
  }
  const Wrench planar = PlanarDrft(blades).wrench(kMedium, m);
  const Wrench spatial = SpatialDrft(blades).wrench(kMedium, m);
  EXPECT_GT(planar.force_n.x, 1.0);
  EXPECT_LT(planar.torque_nm.y, -0.01);
  EXPECT_GT(spatial.force_n.x, 1.0);
  EXPECT_LT(spatial.torque_nm.y, -0.01);
}

TEST(DrftTest, BuriedCylinderConvergesToTheClosedForm) {
  // Straight down: alpha_z = 0.564 + 0.436 cos 2b on the lower half, at the depth d + r cos b, and
  // lambda rho v^2 cos^2 b along the normal.
  const double d = 0.06, v = 0.9;
  BodyMotion m = motion_at(kPi / 2, v);
  m.depth_m = d;
  const double exact =
      kMedium.stress_npm3 * kWidth_m * kRadius_m *
          (0.564 * kPi * d + kRadius_m * (2.0 * 0.564 + 0.436 * 2.0 / 3.0)) +
      kMedium.inertia * kMedium.density_kgpm3 * v * v * kWidth_m * kRadius_m * 4.0 / 3.0;
  double before = exact;
  for (const int around : {20, 100, 400}) {
    const Wrench w = PlanarDrft(cylinder_rim(kRadius_m, kWidth_m, around, 1)).wrench(kMedium, m);
    const double error = std::fabs(w.force_n.z - exact);
    EXPECT_LT(error, 0.1 * before) << around;
    EXPECT_NEAR(w.force_n.x, 0.0, 1e-9);
    before = error;
  }
  EXPECT_LT(before, 1e-4 * exact);
}

TEST(DrftTest, FourHundredElementsOnTheWholeFootAreEnough) {
  std::vector<SurfaceElement> fine = cylinder_rim(kRadius_m, kWidth_m, 800, 20);
  for (const double side : {-1.0, 1.0}) {
    const auto end = cylinder_end(kRadius_m, kWidth_m, 80, 320, side);
    fine.insert(fine.end(), end.begin(), end.end());
  }
  const BodyMotion m = any_motion(false);
  const Vector a = SpatialDrft(whole_foot()).wrench(kMedium, m).force_n;
  const Vector b = SpatialDrft(fine).wrench(kMedium, m).force_n;
  expect_near(a, b, 0.02 * std::sqrt(sim::dot(b, b)));
}

}  // namespace
}  // namespace sandrunner::bench
