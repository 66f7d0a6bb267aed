// SPDX-License-Identifier: BSD-3-Clause
// The dynamics and the step in float, and free flight: what the equations conserve.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

TEST(DynamicsTest, FloatAgreesWithDouble) {
  const RobotModel<double> model = load_raibo().model;
  const RobotModel<float> narrow = convert_model<float>(model);
  Draw draw(1);
  double mass_error = 0.0, bias_error = 0.0, acceleration_error = 0.0;
  for (int n = 0; n < 1000; ++n) {
    // The same state to the last bit: one that float can hold.
    const RigidState<float> y = convert<float>(random_state(draw));
    RigidState<double> x;
    x.position = {y.position.x, y.position.y, y.position.z};
    x.orientation = {y.orientation.w, y.orientation.x, y.orientation.y, y.orientation.z};
    x.velocity = {y.velocity.x, y.velocity.y, y.velocity.z};
    x.angular_velocity = {y.angular_velocity.x, y.angular_velocity.y, y.angular_velocity.z};
    std::array<double, kNumJoints> torque;
    std::array<float, kNumJoints> narrow_torque;
    for (int j = 0; j < kNumJoints; ++j) {
      x.q[j] = y.q[j];
      x.qd[j] = y.qd[j];
      narrow_torque[j] = static_cast<float>(draw(-60.0, 60.0));
      torque[j] = narrow_torque[j];
    }
    Dynamics<double> wide_dynamics;
    Dynamics<float> narrow_dynamics;
    wide_dynamics.update(model, x);
    narrow_dynamics.update(narrow, y);
    const DenseDynamics<double> wide_dense(wide_dynamics);
    const DenseDynamics<float> narrow_dense(narrow_dynamics);
    mass_error = std::fmax(mass_error, relative_error(narrow_dense.mass, wide_dense.mass));
    bias_error = std::fmax(bias_error, relative_error(narrow_dense.bias, wide_dense.bias));
    acceleration_error = std::fmax(
        acceleration_error, relative_error(flat(narrow_dynamics.free_acceleration(narrow_torque)),
                                           flat(wide_dynamics.free_acceleration(torque))));
  }
  EXPECT_LT(mass_error, 1e-6);
  EXPECT_LT(bias_error, 5e-6);
  EXPECT_LT(acceleration_error, 1e-5);
  RecordProperty("worst", testing::PrintToString(
                              std::vector<double>{mass_error, bias_error, acceleration_error}));
}

double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

struct Drift {
  double energy_j, linear_ns, angular_nms, com_m;
};
/// 0.2 s of tumbling 100 m above the ground, all joints moving.
Drift tumble(double dt_s, std::uint64_t seed) {
  Bench bench;
  bench.settings.dt_s = dt_s;
  Draw draw(seed);
  RigidState<double>& x = bench.state.rigid;
  const RigidState<double> random = random_state(draw);
  x.orientation = random.orientation;
  x.velocity = random.velocity;
  x.angular_velocity = random.angular_velocity;
  x.position.z = 100.0;
  for (double& qd : x.qd) qd = draw(-4.0, 4.0);
  bench.remove_stops();
  const Invariants start = invariants(bench.robot.model, x);
  const double duration_s = 0.2, m = bench.robot.model.mass();
  for (int i = 0; i < std::lround(duration_s / dt_s); ++i) bench.step({});
  const Invariants end = invariants(bench.robot.model, x);
  const Vec3<double> weight{0.0, 0.0, -m * kGravity_mps2 * duration_s};
  const Vec3<double> flight =
      mul_add(start.linear, duration_s / m, start.com) +
      Vec3<double>{0.0, 0.0, -0.5 * kGravity_mps2 * duration_s * duration_s};
  return {std::fabs(end.energy_j - start.energy_j), length(end.linear - start.linear - weight),
          length(end.angular - start.angular), length(end.com - flight)};
}

TEST(FreeFlightTest, EnergyAndMomentumConvergeLinearlyWithTheTimeStep) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    SCOPED_TRACE(seed);
    const Drift coarse = tumble(0.5e-3, seed), middle = tumble(0.25e-3, seed),
                fine = tumble(0.125e-3, seed);
    const auto halves = [](double c, double m, double f, const char* what) {
      EXPECT_GT(c / m, 1.7) << what;
      EXPECT_LT(c / m, 2.3) << what;
      EXPECT_GT(m / f, 1.7) << what;
      EXPECT_LT(m / f, 2.3) << what;
    };
    halves(coarse.energy_j, middle.energy_j, fine.energy_j, "energy");
    halves(coarse.linear_ns, middle.linear_ns, fine.linear_ns, "linear momentum");
    halves(coarse.angular_nms, middle.angular_nms, fine.angular_nms, "angular momentum");
    halves(coarse.com_m, middle.com_m, fine.com_m, "centre of mass");
    RecordProperty("drift" + std::to_string(seed),
                   testing::PrintToString(std::vector<double>{middle.energy_j, middle.linear_ns,
                                                              middle.angular_nms, middle.com_m}));
  }
}

TEST(FreeFlightTest, WithoutRotationFallsAsAPoint) {
  // Nothing turns, so every body falls alike and semi-implicit Euler has a closed form:
  // z(n) = z0 + v0 t - g t (t + dt)/2.
  Bench bench;
  RigidState<double>& x = bench.state.rigid;
  Draw draw(1);
  x.orientation = random_state(draw).orientation;
  x.position.z = 100.0;
  x.velocity = {1.0, -2.0, 3.0};
  const Robot& robot = bench.robot;
  for (int i = 0; i < 800; ++i) bench.step({});
  const double t = 0.2, dt = bench.settings.dt_s;
  EXPECT_NEAR(x.position.x, 1.0 * t, 1e-12);
  EXPECT_NEAR(x.position.y, -2.0 * t, 1e-12);
  EXPECT_NEAR(x.position.z, 100.0 + 3.0 * t - 0.5 * kGravity_mps2 * t * (t + dt), 1e-11);
  EXPECT_NEAR(x.velocity.z, 3.0 - kGravity_mps2 * t, 1e-12);
  for (int j = 0; j < kNumJoints; ++j) EXPECT_NEAR(x.q[j], robot.nominal_rad[j], 1e-11);
  EXPECT_LT(length(x.angular_velocity), 1e-11);
  // The accelerometer of a falling body feels nothing.
  EXPECT_LT(length(mul_add(rotation_matrix(x.orientation).r2, kGravity_mps2,
                           bench.report.base_acceleration)),
            1e-9);
}

TEST(FreeFlightTest, TorquesDoTheWorkThatTheEnergyGains) {
  // Work of the joint torques equals the gain of energy, to first order in dt.
  const auto imbalance = [](double dt_s) {
    Bench bench;
    bench.settings.dt_s = dt_s;
    bench.remove_stops();
    RigidState<double>& x = bench.state.rigid;
    x.position.z = 100.0;
    Draw draw(9);
    std::array<double, kNumJoints> torque;
    for (double& t : torque) t = draw(-3.0, 3.0);
    const double before = invariants(bench.robot.model, x).energy_j;
    double work = 0.0;
    for (int i = 0; i < std::lround(0.05 / dt_s); ++i) {
      const auto q = x.q;
      bench.step(torque);
      for (int j = 0; j < kNumJoints; ++j) work += torque[j] * (x.q[j] - q[j]);
    }
    EXPECT_GT(work, 1.0);
    return (invariants(bench.robot.model, x).energy_j - before - work) / work;
  };
  const double coarse = imbalance(0.25e-3), fine = imbalance(0.125e-3);
  EXPECT_LT(std::fabs(coarse), 0.02);
  EXPECT_NEAR(coarse / fine, 2.0, 0.3);
}

}  // namespace
}  // namespace sandrunner::sim
