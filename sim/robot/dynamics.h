// SPDX-License-Identifier: BSD-3-Clause
// Equations of motion of the quadruped, written for its fixed topology. The mass matrix has one 6x6
// block (base), four 3x3 blocks (legs) and four 6x3 couplings; each leg is treated in its hip
// frame, where the axes of HFE and KFE are constant, then eliminated onto the base (Schur
// complement), which leaves one 6x6 LDL^T factorisation.
//
// Generalised velocity: base origin's velocity and base angular velocity in *body* components, then
// 12 joint rates. Accelerations are the plain time derivative of the base origin's velocity (in
// body components), not the spatial one, so that R a integrates the world velocity directly.
#pragma once

#include <array>

#include "rt/core/messages.h"
#include "sim/lanes/vec.h"
#include "sim/robot/robot_model.h"

namespace sandrunner::sim {

/// Configuration and velocity of one robot (or one per lane). Joints in the order of
/// messages.h: HAA, HFE, KFE of the legs left front, right front, left hind, right hind.
template <typename S>
struct RigidState {
  Vec3<S> position;                ///< base origin, world, m
  Quaternion<S> orientation;       ///< body to world
  std::array<S, kNumJoints> q{};   ///< joint positions, rad
  Vec3<S> velocity;                ///< of the base origin, world, m/s
  Vec3<S> angular_velocity;        ///< body frame, rad/s
  std::array<S, kNumJoints> qd{};  ///< joint velocities, rad/s
};

/// A generalised velocity (m/s, rad/s), acceleration (m/s^2, rad/s^2), force (N, N m) or impulse
/// (N s, N m s): base linear and angular part in body components, joints.
template <typename S>
struct Motion {
  Vec3<S> linear, angular;
  std::array<S, kNumJoints> joint{};
};

/// Inverse of a symmetric positive definite 3x3 matrix.
template <typename S>
inline Sym3<S> inverse(const Sym3<S>& m) noexcept {
  const S cxx = diff_of_products(m.yy, m.zz, m.yz, m.yz);
  const S cxy = diff_of_products(m.xz, m.yz, m.xy, m.zz);
  const S cxz = diff_of_products(m.xy, m.yz, m.xz, m.yy);
  const S det = fma(m.xx, cxx, fma(m.xy, cxy, m.xz * cxz));
  const S d = S(1.0) / det;
  return {cxx * d,
          cxy * d,
          cxz * d,
          diff_of_products(m.xx, m.zz, m.xz, m.xz) * d,
          diff_of_products(m.xy, m.xz, m.xx, m.yz) * d,
          diff_of_products(m.xx, m.yy, m.xy, m.xy) * d};
}

/// Sine and cosine of a leg's angles, and its points in the hip frame relative to the HAA origin,
/// m.
template <typename S>
struct LegPose {
  S s1, c1;            ///< HAA
  S s2, c2, s23, c23;  ///< HFE, HFE + KFE
  Vec3<S> knee, foot;  ///< KFE origin and foot centre, hip frame
};

/// q1, q2, q3: positions of HAA, HFE and KFE, rad.
template <typename S>
inline LegPose<S> leg_pose(const LegModel<S>& leg, S q1, S q2, S q3) noexcept {
  LegPose<S> p;
  const S hfe = leg.sign[1] * q2;
  sincos(leg.sign[0] * q1, p.s1, p.c1);
  sincos(hfe, p.s2, p.c2);
  sincos(fma(leg.sign[2], q3, hfe), p.s23, p.c23);
  p.knee = leg.hfe + rotate_y(p.s2, p.c2, leg.kfe);
  p.foot = p.knee + rotate_y(p.s23, p.c23, leg.foot);
  return p;
}

/// Position in the base frame, from the base origin, of a point given in the hip frame, m.
template <typename S>
inline Vec3<S> hip_to_base(const LegModel<S>& leg, const LegPose<S>& p, const Vec3<S>& v) noexcept {
  return leg.haa + rotate_x(p.s1, p.c1, v);
}

/// Centre of one of the foot's patches, hip frame, m.
template <typename S>
inline Vec3<S> patch_centre(const LegModel<S>& leg, const LegPose<S>& p, int patch) noexcept {
  return p.foot + rotate_y(p.s23, p.c23, leg.patch[static_cast<std::size_t>(patch)]);
}

/// Mass matrix, bias and their factorisation at one configuration and velocity. SI units
/// throughout: kg, m, kg m^2, rad.
template <typename S>
class Dynamics {
 public:
  /// Evaluates everything that the configuration and velocity determine.
  void update(const RobotModel<S>& model, const RigidState<S>& x) noexcept;

  /// Acceleration under joint torques alone (gravity included).
  Motion<S> free_acceleration(const std::array<S, kNumJoints>& torque_nm) const noexcept;

  /// M^-1 f for a generalised force or impulse f.
  Motion<S> solve(const Motion<S>& f) const noexcept;

  const LegPose<S>& leg(int l) const noexcept { return legs_[l].pose; }
  /// Columns of a leg's Jacobian in base components: velocity of a point fixed to the shank (or,
  /// with the third column dropped, the thigh) at `r_hip` (hip frame, relative to HAA) per joint
  /// rate.
  std::array<Vec3<S>, 3> leg_jacobian(const RobotModel<S>& model, int l,
                                      const Vec3<S>& r_hip) const noexcept {
    const LegPose<S>& p = legs_[l].pose;
    const Vec3<S> from_hfe = r_hip - model.legs[l].hfe;
    const Vec3<S> from_knee = r_hip - p.knee;
    const std::array<S, kJointsPerLeg>& sign = model.legs[l].sign;
    return {sign[0] * rotate_x(p.s1, p.c1, Vec3<S>{S(0.0), -r_hip.z, r_hip.y}),
            sign[1] * rotate_x(p.s1, p.c1, Vec3<S>{from_hfe.z, S(0.0), -from_hfe.x}),
            sign[2] * rotate_x(p.s1, p.c1, Vec3<S>{from_knee.z, S(0.0), -from_knee.x})};
  }

  /// Inverse of a leg's own 3x3 mass matrix.
  const Sym3<S>& leg_inverse(int l) const noexcept { return legs_[l].inverse; }
  /// Row j of Y = M_ll^-1 M_lb (joint j of leg l per base acceleration): linear part, angular part.
  Vec3<S> y_linear(int l, int j) const noexcept {
    const std::array<S, 6>& y = legs_[l].y[j];
    return {y[0], y[1], y[2]};
  }
  Vec3<S> y_angular(int l, int j) const noexcept {
    const std::array<S, 6>& y = legs_[l].y[j];
    return {y[3], y[4], y[5]};
  }
  /// D^-1/2 L^-1 b for a base force b (linear, angular): the square root in which Delassus blocks
  /// are inner products.
  std::array<S, 6> half_solve(const Vec3<S>& linear, const Vec3<S>& angular) const noexcept;
  /// Base motion L^-T D^-1/2 y.
  void back_solve(const std::array<S, 6>& y, Vec3<S>& linear, Vec3<S>& angular) const noexcept;

 private:
  template <typename>
  friend struct DenseDynamics;  // of tests

  struct Leg {
    LegPose<S> pose;
    Sym3<S> mass;  // M_ll with rotor inertia
    Sym3<S> inverse;
    // M_bl: force and torque about the base origin per joint acceleration.
    std::array<std::array<S, 6>, 3> coupling;
    std::array<std::array<S, 6>, 3> y;  // M_ll^-1 M_lb: per base acceleration, linear and angular
    std::array<S, 3> bias;
  };
  void update_leg(const RobotModel<S>& model, const RigidState<S>& x, int l,
                  const Vec3<S>& base_acceleration) noexcept;
  void factorise() noexcept;

  std::array<Leg, kNumLegs> legs_;
  // Composite body: mass, first moment and inertia about the base origin; bias wrench about it.
  S mass_{};
  Vec3<S> moment_;
  Sym3<S> inertia_;
  Vec3<S> bias_force_, bias_torque_;
  // Schur complement = L D L^T, L unit lower triangular packed by rows.
  std::array<S, 15> l_{};
  std::array<S, 6> d_inverse_sqrt_{};
};

template <typename S>
void Dynamics<S>::update_leg(const RobotModel<S>& model, const RigidState<S>& x, int l,
                             const Vec3<S>& gravity_up) noexcept {
  const LegModel<S>& m = model.legs[l];
  Leg& leg = legs_[l];
  leg.pose = leg_pose(m, x.q[3 * l], x.q[3 * l + 1], x.q[3 * l + 2]);
  const LegPose<S>& p = leg.pose;
  const S m1 = m.hip.mass, m2 = m.thigh.mass, m3 = m.shank.mass;
  const auto moment = [](const Sym3<S>& inertia, const Vec3<S>& dw, const Vec3<S>& w) {
    return cross_add(w, inertia * w, inertia * dw);
  };
  const auto cross_y = [](const Vec3<S>& r, const Vec3<S>& f) {  // (r x f).y
    return diff_of_products(r.z, f.x, r.x, f.z);
  };

  // Body by body outwards, all in the hip frame: velocity and bias acceleration (recursive
  // Newton-Euler at zero acceleration; gravity enters as an upward acceleration of the base), and
  // what the body adds to the leg's bias wrench, first moment and inertia about the HAA origin. One
  // body is finished before the next is begun: there are too few registers for more.
  const S qd1 = m.sign[0] * x.qd[3 * l], qd2 = m.sign[1] * x.qd[3 * l + 1];
  const S qd3 = m.sign[2] * x.qd[3 * l + 2];
  const Vec3<S>& wb = x.angular_velocity;
  const Vec3<S> a0 = unrotate_x(p.s1, p.c1, cross_add(wb, cross(wb, m.haa), gravity_up));
  const Vec3<S> w0 = unrotate_x(p.s1, p.c1, wb);
  const Vec3<S> w1{w0.x + qd1, w0.y, w0.z};
  const Vec3<S> dw1{S(0.0), w0.z * qd1, -(w0.y * qd1)};  // w0 x ex qd1
  const Mat3<S> turn1 = turning_acceleration(dw1, w1);
  Vec3<S> bias_force = m1 * mul_add(turn1, m.hip.com, a0);
  Vec3<S> bias_torque = cross_add(m.hip.com, bias_force, moment(m.hip.inertia, dw1, w1));
  Vec3<S> moment_haa = m1 * m.hip.com;
  Sym3<S> inertia_haa = shifted_inertia(m.hip.inertia, m1, m.hip.com);
  const Vec3<S> a_hfe = mul_add(turn1, m.hfe, a0);

  const Vec3<S> w2{w1.x, w1.y + qd2, w1.z};
  const Vec3<S> dw2{fma(-w1.z, qd2, dw1.x), dw1.y, fma(w1.x, qd2, dw1.z)};  // + w1 x ey qd2
  const Mat3<S> turn2 = turning_acceleration(dw2, w2);
  const Vec3<S> thigh_arm = rotate_y(p.s2, p.c2, m.thigh.com);
  const Sym3<S> thigh_inertia = rotate_y(p.s2, p.c2, m.thigh.inertia);
  const Vec3<S> thigh_com = m.hfe + thigh_arm;
  const Vec3<S> f2 = m2 * mul_add(turn2, thigh_arm, a_hfe);
  const Vec3<S> n2 = moment(thigh_inertia, dw2, w2);
  bias_force = bias_force + f2;
  bias_torque = bias_torque + cross_add(thigh_com, f2, n2);
  const S bias_hfe = n2.y + cross_y(thigh_arm, f2);
  moment_haa = mul_add(thigh_com, m2, moment_haa);
  inertia_haa = inertia_haa + shifted_inertia(thigh_inertia, m2, thigh_com);
  const Vec3<S> knee_from_hfe = p.knee - m.hfe;
  const Vec3<S> a_knee = mul_add(turn2, knee_from_hfe, a_hfe);
  const Vec3<S> moment2_hfe = m2 * thigh_arm;
  const Sym3<S> inertia2_hfe = shifted_inertia(thigh_inertia, m2, thigh_arm);

  const Vec3<S> w3{w2.x, w2.y + qd3, w2.z};
  const Vec3<S> dw3{fma(-w1.z, qd3, dw2.x), dw2.y, fma(w1.x, qd3, dw2.z)};
  const Vec3<S> shank_arm = rotate_y(p.s23, p.c23, m.shank.com);
  const Sym3<S> shank_inertia = rotate_y(p.s23, p.c23, m.shank.inertia);
  const Vec3<S> shank_com = p.knee + shank_arm;
  const Vec3<S> f3 = m3 * mul_add(turning_acceleration(dw3, w3), shank_arm, a_knee);
  const Vec3<S> n3 = moment(shank_inertia, dw3, w3);
  bias_force = bias_force + f3;
  bias_torque = bias_torque + cross_add(shank_com, f3, n3);
  const Vec3<S> shank_from_hfe = knee_from_hfe + shank_arm;
  leg.bias[2] = m.sign[2] * (n3.y + cross_y(shank_arm, f3));
  leg.bias[1] = m.sign[1] * ((bias_hfe + n3.y) + cross_y(shank_from_hfe, f3));
  leg.bias[0] = m.sign[0] * bias_torque.x;
  moment_haa = mul_add(shank_com, m3, moment_haa);
  inertia_haa = inertia_haa + shifted_inertia(shank_inertia, m3, shank_com);

  // Composite bodies of the outer joints: shank (about the knee), thigh and shank (about HFE).
  const Vec3<S> moment3 = m3 * shank_arm;
  const Vec3<S> moment23_hfe = mul_add(shank_from_hfe, m3, moment2_hfe);
  const Sym3<S> inertia_shank_knee = shifted_inertia(shank_inertia, m3, shank_arm);
  const Sym3<S> inertia23_hfe = inertia2_hfe + shifted_inertia(shank_inertia, m3, shank_from_hfe);
  // Columns in the hip frame: force on the composite per joint acceleration (axis x first moment),
  // and torque about the HAA origin (torque about the joint plus arm x force).
  const Vec3<S> force3{moment3.z, S(0.0), -moment3.x};  // ey x moment
  const Vec3<S> force2{moment23_hfe.z, S(0.0), -moment23_hfe.x};
  const Vec3<S> force1{S(0.0), -moment_haa.z, moment_haa.y};  // ex x moment
  const Vec3<S> knee_torque3{inertia_shank_knee.xy, inertia_shank_knee.yy, inertia_shank_knee.yz};
  const Vec3<S> hfe_torque2{inertia23_hfe.xy, inertia23_hfe.yy, inertia23_hfe.yz};
  const auto arm_cross = [](const Vec3<S>& r, const Vec3<S>& f, const Vec3<S>& torque) {
    return Vec3<S>{fma(r.y, f.z, torque.x), fma(r.z, f.x, fma(-r.x, f.z, torque.y)),
                   fma(-r.y, f.x, torque.z)};  // r x f + torque, f.y = 0
  };
  const Vec3<S> torque3 = arm_cross(p.knee, force3, knee_torque3);
  const Vec3<S> torque2 = arm_cross(m.hfe, force2, hfe_torque2);
  const Vec3<S> torque1{inertia_haa.xx, inertia_haa.xy, inertia_haa.xz};
  leg.mass = {torque1.x + model.rotor_inertia[3 * l],
              m.sign[0] * m.sign[1] * torque2.x,
              m.sign[0] * m.sign[2] * torque3.x,
              hfe_torque2.y + model.rotor_inertia[3 * l + 1],
              m.sign[1] * m.sign[2] * (knee_torque3.y + cross_y(knee_from_hfe, force3)),
              knee_torque3.y + model.rotor_inertia[3 * l + 2]};

  // To the base: rotate by HAA, shift to the base origin, add up.
  const std::array<Vec3<S>, 3> forces{force1, force2, force3};
  const std::array<Vec3<S>, 3> torques{torque1, torque2, torque3};
  for (int j = 0; j < 3; ++j) {
    const Vec3<S> f = m.sign[j] * rotate_x(p.s1, p.c1, forces[j]);
    const Vec3<S> t = cross_add(m.haa, f, m.sign[j] * rotate_x(p.s1, p.c1, torques[j]));
    leg.coupling[j] = {f.x, f.y, f.z, t.x, t.y, t.z};
  }
  const Vec3<S> base_force = rotate_x(p.s1, p.c1, bias_force);
  bias_force_ = bias_force_ + base_force;
  bias_torque_ = bias_torque_ + cross_add(m.haa, base_force, rotate_x(p.s1, p.c1, bias_torque));
  const S leg_mass = (m1 + m2) + m3;
  const Vec3<S> moment_rotated = rotate_x(p.s1, p.c1, moment_haa);
  mass_ = mass_ + leg_mass;
  moment_ = moment_ + mul_add(m.haa, leg_mass, moment_rotated);
  // Inertia about the base origin: J + 2 (o.h) 1 - o h^T - h o^T + m (|o|^2 1 - o o^T), with h
  // about HAA.
  const Vec3<S>& o = m.haa;
  const Vec3<S> g = mul_add(o, S(0.5) * leg_mass, moment_rotated);  // h + m o / 2
  const Sym3<S> rotated = rotate_x(p.s1, p.c1, inertia_haa);
  const S ox = (o.x + o.x) * g.x, oy = (o.y + o.y) * g.y, oz = (o.z + o.z) * g.z;
  inertia_ = inertia_ + Sym3<S>{rotated.xx + (oy + oz),
                                fma(-o.x, g.y, fma(-o.y, g.x, rotated.xy)),
                                fma(-o.x, g.z, fma(-o.z, g.x, rotated.xz)),
                                rotated.yy + (ox + oz),
                                fma(-o.y, g.z, fma(-o.z, g.y, rotated.yz)),
                                rotated.zz + (ox + oy)};

  // Eliminate the leg: Y = M_ll^-1 M_lb.
  leg.inverse = inverse(leg.mass);
  const Sym3<S>& i = leg.inverse;
  const std::array<std::array<S, 3>, 3> rows{
      {{i.xx, i.xy, i.xz}, {i.xy, i.yy, i.yz}, {i.xz, i.yz, i.zz}}};
  for (int j = 0; j < 3; ++j) {
    for (int c = 0; c < 6; ++c) {
      leg.y[j][c] = fma(leg.coupling[0][c], rows[j][0],
                        fma(leg.coupling[1][c], rows[j][1], rows[j][2] * leg.coupling[2][c]));
    }
  }
}

template <typename S>
void Dynamics<S>::update(const RobotModel<S>& model, const RigidState<S>& x) noexcept {
  const Mat3<S> r = rotation_matrix(x.orientation);
  const Vec3<S> gravity_up = S(kGravity_mps2) * r.r2;  // R^T (0, 0, g)
  const Vec3<S>& w = x.angular_velocity;
  const Body<S>& b = model.base;
  mass_ = b.mass;
  moment_ = b.mass * b.com;
  inertia_ = shifted_inertia(b.inertia, b.mass, b.com);
  bias_force_ = b.mass * cross_add(w, cross(w, b.com), gravity_up);
  bias_torque_ = cross_add(b.com, bias_force_, cross(w, b.inertia * w));
  for (int l = 0; l < kNumLegs; ++l) update_leg(model, x, l, gravity_up);
  factorise();
}

template <typename S>
void Dynamics<S>::factorise() noexcept {
  // Lower triangle of the Schur complement by rows; rows and columns 0..2 linear, 3..5 angular.
  const S zero = S(0.0);
  std::array<std::array<S, 6>, 6> a;
  a[0] = {mass_, zero, zero, zero, zero, zero};
  a[1] = {zero, mass_, zero, zero, zero, zero};
  a[2] = {zero, zero, mass_, zero, zero, zero};
  a[3] = {zero, -moment_.z, moment_.y, inertia_.xx, zero, zero};  // [h]x
  a[4] = {moment_.z, zero, -moment_.x, inertia_.xy, inertia_.yy, zero};
  a[5] = {-moment_.y, moment_.x, zero, inertia_.xz, inertia_.yz, inertia_.zz};
  // Row by row, so that the sums stay in registers.
#pragma GCC unroll 6
  for (int r = 0; r < 6; ++r) {
    std::array<S, 6> row = a[r];
    for (int l = 0; l < kNumLegs; ++l) {
      for (int j = 0; j < 3; ++j) {
        const S m = -legs_[l].coupling[j][r];
        for (int c = 0; c <= r; ++c) row[c] = fma(m, legs_[l].y[j][c], row[c]);
      }
    }
    a[r] = row;
  }
  // LDL^T, column by column; `scaled` holds l_ik d_k.
  std::array<S, 15> scaled;
  for (int j = 0; j < 6; ++j) {
    const int row = j * (j - 1) / 2;
    S d = a[j][j];
    for (int k = 0; k < j; ++k) d = fma(-scaled[row + k], l_[row + k], d);
    const S d_inverse = S(1.0) / d;
    d_inverse_sqrt_[j] = sqrt(d_inverse);
    for (int i = j + 1; i < 6; ++i) {
      const int other = i * (i - 1) / 2;
      S v = a[i][j];
      for (int k = 0; k < j; ++k) v = fma(-scaled[other + k], l_[row + k], v);
      scaled[other + j] = v;
      l_[other + j] = v * d_inverse;
    }
  }
}

template <typename S>
std::array<S, 6> Dynamics<S>::half_solve(const Vec3<S>& linear,
                                         const Vec3<S>& angular) const noexcept {
  std::array<S, 6> y{linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
  for (int i = 1; i < 6; ++i) {
    for (int k = 0; k < i; ++k) y[i] = fma(-l_[i * (i - 1) / 2 + k], y[k], y[i]);
  }
  for (int i = 0; i < 6; ++i) y[i] = y[i] * d_inverse_sqrt_[i];
  return y;
}

template <typename S>
void Dynamics<S>::back_solve(const std::array<S, 6>& y, Vec3<S>& linear,
                             Vec3<S>& angular) const noexcept {
  std::array<S, 6> v;
  for (int i = 5; i >= 0; --i) {
    v[i] = y[i] * d_inverse_sqrt_[i];
    for (int k = i + 1; k < 6; ++k) v[i] = fma(-l_[k * (k - 1) / 2 + i], v[k], v[i]);
  }
  linear = {v[0], v[1], v[2]};
  angular = {v[3], v[4], v[5]};
}

template <typename S>
Motion<S> Dynamics<S>::solve(const Motion<S>& f) const noexcept {
  Motion<S> a;
  Vec3<S> linear = f.linear, angular = f.angular;
  for (int l = 0; l < kNumLegs; ++l) {
    for (int j = 0; j < 3; ++j) {
      linear = mul_add(y_linear(l, j), -f.joint[3 * l + j], linear);
      angular = mul_add(y_angular(l, j), -f.joint[3 * l + j], angular);
    }
  }
  back_solve(half_solve(linear, angular), a.linear, a.angular);
  for (int l = 0; l < kNumLegs; ++l) {
    const Leg& leg = legs_[l];
    const Vec3<S> z = leg.inverse * Vec3<S>{f.joint[3 * l], f.joint[3 * l + 1], f.joint[3 * l + 2]};
    const std::array<S, 3> zs{z.x, z.y, z.z};
    for (int j = 0; j < 3; ++j) {
      a.joint[3 * l + j] =
          zs[j] - (dot(y_linear(l, j), a.linear) + dot(y_angular(l, j), a.angular));
    }
  }
  return a;
}

template <typename S>
Motion<S> Dynamics<S>::free_acceleration(
    const std::array<S, kNumJoints>& torque_nm) const noexcept {
  Motion<S> f;
  f.linear = S(-1.0) * bias_force_;
  f.angular = S(-1.0) * bias_torque_;
  for (int l = 0; l < kNumLegs; ++l) {
    for (int j = 0; j < 3; ++j) f.joint[3 * l + j] = torque_nm[3 * l + j] - legs_[l].bias[j];
  }
  return solve(f);
}

}  // namespace sandrunner::sim
