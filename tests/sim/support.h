// SPDX-License-Identifier: BSD-3-Clause
// What several tests of the simulator need: reproducible draws, random states of the robot, the
// step without the program around it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "rt/core/safety_gate.h"
#include "sim/ground/ground.h"
#include "sim/ground/terrain_description.h"
#include "sim/lanes/random.h"
#include "sim/robot/embedded.h"
#include "sim/robot/robot_model.h"
#include "sim/simulator.h"
#include "sim/step/robot_step.h"
#include "tests/support/all_joints.h"

namespace sandrunner::sim {

/// Uniform draws from a seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * random_uniform(seed_, 0, counter_++);
  }
  Vec3<double> vector(double size) {
    return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)};
  }

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
};

/// Any orientation and joint angles; speeds up to those of a fast run.
inline RigidState<double> random_state(Draw& draw) {
  RigidState<double> x;
  x.position = draw.vector(2.0);
  Quaternion<double> q{draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1)};
  const double n = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  x.orientation = {q.w / n, q.x / n, q.y / n, q.z / n};
  x.velocity = draw.vector(4.0);
  x.angular_velocity = draw.vector(6.0);
  for (int j = 0; j < kNumJoints; ++j) {
    x.q[j] = draw(-3.0, 3.0);
    x.qd[j] = draw(-20.0, 20.0);
  }
  return x;
}

template <typename To>
Vec3<To> convert(const Vec3<double>& v) {
  return {To(v.x), To(v.y), To(v.z)};
}
template <typename To>
RigidState<To> convert(const RigidState<double>& from) {
  RigidState<To> to;
  to.position = convert<To>(from.position);
  to.orientation = {To(from.orientation.w), To(from.orientation.x), To(from.orientation.y),
                    To(from.orientation.z)};
  to.velocity = convert<To>(from.velocity);
  to.angular_velocity = convert<To>(from.angular_velocity);
  for (int j = 0; j < kNumJoints; ++j) {
    to.q[j] = To(from.q[j]);
    to.qd[j] = To(from.qd[j]);
  }
  return to;
}
template <typename S>
std::array<double, 18> flat(const Motion<S>& m) {
  std::array<double, 18> f{m.linear.x,  m.linear.y,  m.linear.z,
                           m.angular.x, m.angular.y, m.angular.z};
  for (int j = 0; j < kNumJoints; ++j) f[6 + j] = m.joint[j];
  return f;
}

/// |a - b| / |b| over all elements.
template <typename A, typename B>
double relative_error(const A& a, const B& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    difference += d * d;
    size += static_cast<double>(b[i]) * static_cast<double>(b[i]);
  }
  return std::sqrt(difference / size);
}

/// What a Dynamics has computed, in the coordinates of Motion.
template <typename S>
struct DenseDynamics {
  explicit DenseDynamics(const Dynamics<S>& d)
      : bias{d.bias_force_.x,  d.bias_force_.y,  d.bias_force_.z,
             d.bias_torque_.x, d.bias_torque_.y, d.bias_torque_.z} {
    const auto put = [&](int r, int c, S v) { mass[18 * r + c] = mass[18 * c + r] = v; };
    for (int i = 0; i < 3; ++i) put(i, i, d.mass_);
    put(3, 1, -d.moment_.z);
    put(3, 2, d.moment_.y);
    put(4, 0, d.moment_.z);
    put(4, 2, -d.moment_.x);
    put(5, 0, -d.moment_.y);
    put(5, 1, d.moment_.x);
    put_block(3, d.inertia_);
    for (int l = 0; l < kNumLegs; ++l) {
      const auto& leg = d.legs_[l];
      const int o = 6 + 3 * l;
      put_block(o, leg.mass);
      for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < 6; ++k) put(k, o + j, leg.coupling[j][k]);
        bias[o + j] = leg.bias[j];
      }
    }
  }

  std::array<S, 324> mass{};  ///< row-major 18x18
  std::array<S, 18> bias;     ///< force needed for zero acceleration, gravity included

 private:
  void put_block(int at, const Sym3<S>& m) {
    const S block[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
    for (int r = 0; r < 3; ++r) std::copy_n(block[r], 3, &mass[18 * (at + r) + at]);
  }
};

/// Kinetic and potential energy, and momenta about the centre of mass, in world axes.
struct Invariants {
  double energy_j;
  Vec3<double> com, linear, angular;
};
inline Invariants invariants(const RobotModel<double>& model, const RigidState<double>& x) {
  Dynamics<double> dynamics;
  dynamics.update(model, x);
  const std::array<double, 324> mass = DenseDynamics<double>(dynamics).mass;
  const Mat3<double> r = rotation_matrix(x.orientation);
  Motion<double> velocity;
  velocity.linear = transposed_times(r, x.velocity);
  velocity.angular = x.angular_velocity;
  velocity.joint = x.qd;
  const std::array<double, 18> v = flat(velocity);
  std::array<double, 18> momentum{};
  double kinetic = 0.0;
  for (int i = 0; i < 18; ++i) {
    for (int k = 0; k < 18; ++k) momentum[i] += mass[18 * i + k] * v[k];
    kinetic += 0.5 * momentum[i] * v[i];
  }
  // First moment about the base origin from the mass matrix: its angular-linear block is [h]x.
  const double m = mass[0];
  const Vec3<double> com_base =
      (1.0 / m) * Vec3<double>{mass[18 * 5 + 1], mass[18 * 3 + 2], mass[18 * 4 + 0]};
  Invariants i;
  i.com = x.position + r * com_base;
  i.linear = r * Vec3<double>{momentum[0], momentum[1], momentum[2]};
  const Vec3<double> about_base = r * Vec3<double>{momentum[3], momentum[4], momentum[5]};
  i.angular = about_base - cross(i.com - x.position, i.linear);
  i.energy_j = kinetic + m * kGravity_mps2 * i.com.z;
  return i;
}

/// The command as the simulator takes it, by a gate whose limits are out of reach.
inline SafeCommand pass_gate(const JointCommand& command) {
  static const SafetyGate gate{{.joint_lower_rad = all_joints(-100.0),
                                .joint_upper_rad = all_joints(100.0),
                                .speed_limit_radps = all_joints(1e3),
                                .torque_limit_nm = all_joints(1e9),
                                .kp_limit_nmprad = 1e3,
                                .kd_limit_nmsprad = 50.0},
                               {1.0, 1.0, 1.0}};
  GateState state;
  return gate.pass(command, true, {}, state);
}
inline JointCommand pd_command(const JointArray<double>& target_rad, double kp, double kd) {
  JointCommand c;
  c.position_rad = target_rad;
  c.kp_nmprad.fill(kp);
  c.kd_nmsprad.fill(kd);
  return c;
}

/// A terrain of one patch.
inline TerrainDescription one_patch(const GroundParameters& ground,
                                    const ShapeParameters& shape = {}) {
  TerrainDescription t;
  t.shape = shape;
  t.patches.push_back({0.0, ground});
  return t;
}
inline GroundParameters ground_of_kind(GroundKind kind) {
  GroundParameters g;
  g.kind = kind;
  return g;
}

inline ShapeParameters waves(double roughness_m) {
  ShapeParameters shape;
  shape.roughness_m = roughness_m;
  return shape;
}
inline ShapeParameters slope(double slope_rad, double heading_rad = 0.0) {
  ShapeParameters shape;
  shape.slope_rad = slope_rad;
  shape.slope_heading_rad = heading_rad;
  return shape;
}

/// RobotStepper with all that one step needs.
struct Bench {
  explicit Bench(const GroundParameters& ground = ground_of_kind(GroundKind::kRigid),
                 const Robot& of = load_raibo(), const ShapeParameters& shape = {})
      : robot(of) {
    const TerrainDescription description = one_patch(ground, shape);
    foot = make_foot_profile(description, robot.model);
    terrain = make_terrain(description, foot, robot.model);
    state.rigid.position.z = robot.nominal_height_m;
    state.rigid.q = robot.nominal_rad;
  }
  void step(const std::array<double, kNumJoints>& torque_nm) {
    stepper.step(robot.model, foot, terrain, settings, torque_nm, state, report);
  }

  void remove_stops() {
    robot.model.lower_rad.fill(-1e3);
    robot.model.upper_rad.fill(1e3);
  }

  Robot robot;
  FootProfile<double> foot;
  Terrain<double> terrain;
  StepSettings settings;
  RobotState<double> state;
  StepReport<double> report;
  RobotStepper<double> stepper;
};

inline std::uint64_t hash_of(const Simulator& simulator) {
  StateHash hash;
  simulator.add_to(hash);
  return hash.value();
}

/// `text` with the first `from` after the first `near` replaced.
inline std::string edited(std::string text, const std::string& near, const std::string& from,
                          const std::string& to) {
  const auto start = text.find(near);
  EXPECT_NE(start, std::string::npos) << near;
  const auto at = text.find(from, start);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Raibo's URDF with a box for each foot: 10 x 8 x 2 cm, level as the robot stands.
inline std::string urdf_with_soles() {
  std::string text(embedded_robot_file("raibo.urdf"));
  const std::string tyre =
      R"(<collision>
      <origin xyz="0 0 0" rpy="1.570796327 0 0"/>
      <geometry><cylinder radius="0.0295" length="0.025"/></geometry>)";
  const std::string box =
      R"(<collision><origin xyz="0 0 0" rpy="0 0.559836 0"/>
      <geometry><box size="0.1 0.08 0.02"/></geometry>)";
  for (int l = 0; l < kNumLegs; ++l) text = edited(text, "_FOOT\">", tyre, box);
  return text;
}
/// Raibo on flat feet. `more`: lines of the robot file's [collision].
inline Robot robot_on_soles(const std::string& more = "") {
  const std::string map = edited(std::string(embedded_robot_file("raibo.toml")), "",
                                 "[collision]\n", "[collision]\n" + more);
  return parse_robot(edited(map, "", "nominal_height_m = 0.4725\n", ""), "soles.toml",
                     urdf_with_soles(), "soles.urdf");
}

}  // namespace sandrunner::sim
