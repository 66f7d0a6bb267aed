// SPDX-License-Identifier: BSD-3-Clause
// The dynamics against MuJoCo, which knows nothing of our block structure: a model written from the
// same RobotModel, compared on random states. Both have the free joint's linear velocity and ours
// differ by the rotation R: MuJoCo's is in world axes, Motion's in body axes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/sim/support.h"
#include "tools/bench/mujoco/mujoco_robot.h"

namespace sandrunner::sim {
namespace {

constexpr int kStates = 1000;
constexpr double kTolerance = 1e-9;

class MujocoTest : public testing::Test {
 protected:
  /// Brings MuJoCo to our state, and evaluates both.
  void evaluate(const RigidState<double>& x, const std::array<double, kNumJoints>& torque_nm) {
    mujoco_.set(x);
    mujoco_.apply(torque_nm);
    mj_forward(model_, data_);
    dynamics_.update(robot_.model, x);
    rotation_ = rotation_matrix(x.orientation);
  }
  /// Element (row, column) of the matrix T = diag(R, 1) that turns our velocities into MuJoCo's.
  double turn(int row, int column) const {
    if (row >= 3 || column >= 3) return row == column ? 1.0 : 0.0;
    const Vec3<double>& r = row == 0 ? rotation_.r0 : row == 1 ? rotation_.r1 : rotation_.r2;
    return column == 0 ? r.x : column == 1 ? r.y : r.z;
  }
  /// T^T f of a force or row vector of MuJoCo.
  std::array<double, 18> to_ours(const double* f) const {
    std::array<double, 18> ours{};
    for (int c = 0; c < 18; ++c) {
      if (c >= 3) {
        ours[c] = f[c];
        continue;
      }
      for (int r = 0; r < 3; ++r) ours[c] += turn(r, c) * f[r];
    }
    return ours;
  }

  const Robot robot_ = load_raibo();
  bench::MujocoRobot mujoco_{robot_.model, {.on_ground = false}};
  const mjModel* const model_ = mujoco_.model();
  mjData* const data_ = mujoco_.data();
  Dynamics<double> dynamics_;
  Mat3<double> rotation_;
};

TEST_F(MujocoTest, MassMatrixBiasAndAccelerationAgreeOnRandomStates) {
  Draw draw(1);
  double worst_mass = 0.0, worst_bias = 0.0, worst_acceleration = 0.0, worst_solve = 0.0;
  for (int n = 0; n < kStates; ++n) {
    const RigidState<double> x = random_state(draw);
    std::array<double, kNumJoints> torque_nm;
    for (double& t : torque_nm) t = draw(-60.0, 60.0);
    evaluate(x, torque_nm);

    const DenseDynamics<double> dense(dynamics_);
    std::array<double, 324> world_mass, expected_mass;
    mj_fullM(model_, world_mass.data(), data_->qM);
    for (int r = 0; r < 18; ++r) {  // M T by rows, then T^T (M T) by columns, M symmetric
      const std::array<double, 18> row = to_ours(&world_mass[18 * r]);
      std::copy(row.begin(), row.end(), &expected_mass[18 * r]);
    }
    for (int c = 0; c < 18; ++c) {
      std::array<double, 18> column;
      for (int r = 0; r < 18; ++r) column[r] = expected_mass[18 * r + c];
      column = to_ours(column.data());
      for (int r = 0; r < 18; ++r) expected_mass[18 * r + c] = column[r];
    }
    worst_mass = std::fmax(worst_mass, relative_error(dense.mass, expected_mass));
    worst_bias = std::fmax(worst_bias, relative_error(dense.bias, to_ours(data_->qfrc_bias)));
    worst_acceleration = std::fmax(
        worst_acceleration,
        relative_error(flat(dynamics_.free_acceleration(torque_nm)), to_ours(data_->qacc)));

    // M^-1 of a random generalised force.
    Motion<double> force;
    force.linear = draw.vector(300.0);
    force.angular = draw.vector(100.0);
    for (double& f : force.joint) f = draw(-60.0, 60.0);
    const std::array<double, 18> ours = flat(force);
    std::array<double, 18> world{};
    for (int r = 0; r < 18; ++r) {
      for (int c = 0; c < 18; ++c) world[r] += turn(r, c) * ours[c];
    }
    std::array<double, 18> solved;
    mj_solveM(model_, data_, solved.data(), world.data(), 1);
    worst_solve = std::fmax(worst_solve,
                            relative_error(flat(dynamics_.solve(force)), to_ours(solved.data())));
  }
  EXPECT_LT(worst_mass, kTolerance);
  EXPECT_LT(worst_bias, kTolerance);
  EXPECT_LT(worst_acceleration, kTolerance);
  EXPECT_LT(worst_solve, kTolerance);
  RecordProperty("worst", fmt::format("mass {:.1e} bias {:.1e} acceleration {:.1e} solve {:.1e}",
                                      worst_mass, worst_bias, worst_acceleration, worst_solve));
}

TEST_F(MujocoTest, FootPositionsAndJacobiansAgreeOnRandomStates) {
  Draw draw(2);
  double worst_position = 0.0, worst_jacobian = 0.0;
  for (int n = 0; n < kStates; ++n) {
    const RigidState<double> x = random_state(draw);
    evaluate(x, {});
    for (int l = 0; l < kNumLegs; ++l) {
      const LegModel<double>& leg = robot_.model.legs[l];
      const LegPose<double>& pose = dynamics_.leg(l);
      // The deepest point: a radius under the foot's centre.
      const Vec3<double> down_base = -robot_.model.foot_radius_m * rotation_.r2;
      const Vec3<double> point_hip = pose.foot + unrotate_x(pose.s1, pose.c1, down_base);
      const Vec3<double> point_base = hip_to_base(leg, pose, point_hip);
      const Vec3<double> point = x.position + rotation_ * point_base;

      const int body = mj_name2id(model_, mjOBJ_BODY, fmt::format("shank{}", l).c_str());
      double centre[3];
      const double foot[3] = {leg.foot.x, leg.foot.y, leg.foot.z};
      mju_rotVecMat(centre, foot, data_->xmat + 9 * body);
      mju_addTo3(centre, data_->xpos + 3 * body);
      const Vec3<double> ours = x.position + rotation_ * hip_to_base(leg, pose, pose.foot);
      worst_position =
          std::fmax(worst_position, std::fabs(ours.x - centre[0]) + std::fabs(ours.y - centre[1]) +
                                        std::fabs(ours.z - centre[2]));

      const double at[3] = {point.x, point.y, point.z};
      std::array<double, 54> world, jacobian{}, expected;
      mj_jac(model_, data_, world.data(), nullptr, at, body);
      for (int r = 0; r < 3; ++r) {
        const std::array<double, 18> row = to_ours(&world[18 * r]);
        std::copy(row.begin(), row.end(), &expected[18 * r]);
      }
      // Ours: R [1, -[r]x, columns of the leg].
      const auto put = [&](int column, const Vec3<double>& base) {
        const Vec3<double> v = rotation_ * base;
        jacobian[column] = v.x;
        jacobian[18 + column] = v.y;
        jacobian[36 + column] = v.z;
      };
      const Vec3<double> axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      const auto columns = dynamics_.leg_jacobian(robot_.model, l, point_hip);
      for (int i = 0; i < 3; ++i) {
        put(i, axes[i]);
        put(3 + i, cross(axes[i], point_base));
        put(6 + 3 * l + i, columns[i]);
      }
      worst_jacobian = std::fmax(worst_jacobian, relative_error(jacobian, expected));
    }
  }
  EXPECT_LT(worst_position, kTolerance);
  EXPECT_LT(worst_jacobian, kTolerance);
  RecordProperty("worst",
                 fmt::format("position {:.1e} jacobian {:.1e}", worst_position, worst_jacobian));
}

}  // namespace
}  // namespace sandrunner::sim
