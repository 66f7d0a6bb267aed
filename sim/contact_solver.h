// SPDX-License-Identifier: BSD-3-Clause
// The contact problem of the paper ("Contact solver", algorithm S1): impulses of all contacts,
// coupled through the robot's inertia. Soft contacts (granular, spring) have a fixed normal impulse
// and a friction disc of fixed radius; hard contacts have lambda_n >= 0, v_n >= 0, lambda_n v_n = 0
// and a disc of radius mu lambda_n; in both the tangential velocity opposes the impulse where the
// disc is reached. Joint stops are one-sided rows of the same problem.
//
// The paper projects lambda_t - c_t v_t onto the disc, contact by contact, until an iteration
// changes less than 1e-5 N s. The fixed point is the same here, but each visit solves its contact
// exactly and the start is warm, so that a few sweeps do. `solve_by_projection` is the paper's own
// iteration, for comparison in tests.
#pragma once

#include <array>

#include "sim/dynamics.h"

namespace sandrunner::sim {

/// One contact point. Rows of the contact frame: two tangents, normal.
template <typename S>
struct PointContact {
  int leg = -1;                         ///< -1: on the base
  Mask<S> active{};                     ///< takes part
  Mask<S> hard{};                       ///< impenetrable; else the normal impulse is given
  S friction{};                         ///< hard: mu
  S disc{};                             ///< soft: radius of the friction disc, N s
  std::array<std::array<S, 6>, 3> w{};  ///< rows of (J_b - J_l Y) L^-T D^-1/2
  std::array<std::array<S, 3>, 3> j{};  ///< rows of J_l (per joint of the leg)
  std::array<std::array<S, 3>, 3> p{};  ///< rows of J_l M_ll^-1
  Sym3<S> g;                            ///< own 3x3 Delassus block, 1/kg
  std::array<S, 3> free{};              ///< velocity without any contact impulse, m/s
  std::array<S, 3> impulse{};           ///< N s; in: start; out: solution
};

/// A joint at its stop. The row's direction points away from the stop.
template <typename S>
struct StopRow {
  int leg = 0;
  Mask<S> active{};
  std::array<S, 6> w{};
  std::array<S, 3> j{};  ///< +-1 at the joint
  std::array<S, 3> p{};
  S g{};
  S free{};     ///< velocity without impulse, less the least velocity allowed, rad/s
  S impulse{};  ///< N m s
};

/// What the impulses do to the robot, in the square-root coordinates of Dynamics::half_solve and
/// per leg.
template <typename S>
struct ImpulseSum {
  std::array<S, 6> y{};
  std::array<std::array<S, 3>, kNumLegs> joint{};
};

template <typename S>
inline void add_impulse(const std::array<S, 6>& w, const std::array<S, 3>& j, int leg, S impulse,
                        ImpulseSum<S>& sum) noexcept {
  for (int i = 0; i < 6; ++i) sum.y[i] = fma(w[i], impulse, sum.y[i]);
  if (leg < 0) return;
  for (int i = 0; i < 3; ++i) sum.joint[leg][i] = fma(j[i], impulse, sum.joint[leg][i]);
}

template <typename S>
inline S row_velocity(const std::array<S, 6>& w, const std::array<S, 3>& p, int leg, S free,
                      const ImpulseSum<S>& sum) noexcept {
  S a = fma(w[0], sum.y[0], free), b = w[1] * sum.y[1];
  a = fma(w[2], sum.y[2], a);
  b = fma(w[3], sum.y[3], b);
  a = fma(w[4], sum.y[4], a);
  b = fma(w[5], sum.y[5], b);
  if (leg >= 0) {
    a = fma(p[0], sum.joint[leg][0], a);
    b = fma(p[1], sum.joint[leg][1], b);
    a = fma(p[2], sum.joint[leg][2], a);
  }
  return a + b;
}

/// argmin 1/2 t^T G t + b^T t over the disc |t| <= radius: the tangential impulse whose velocity G
/// t + b is zero inside the disc and opposes t on its rim. On the rim t = -(G + s 1)^-1 b with s >
/// 0 from Newton's iteration on 1/|t(s)| = 1/radius, which is nearly linear in s: three steps from
/// the isotropic guess reach rounding.
template <typename S>
inline void solve_on_disc(S gxx, S gxy, S gyy, S bx, S by, S radius, S& tx, S& ty) noexcept {
  const S zero = S(0.0);
  const auto solve = [&](S s, S& x, S& y) {
    const S a = gxx + s, d = gyy + s;
    const S inverse_det = S(1.0) / diff_of_products(a, d, gxy, gxy);
    x = diff_of_products(gxy, by, d, bx) * inverse_det;
    y = diff_of_products(gxy, bx, a, by) * inverse_det;
    return inverse_det;
  };
  solve(zero, tx, ty);
  const Mask<S> slides = fma(tx, tx, ty * ty) > radius * radius;
  if (!any(slides)) return;
  const S tiny = S(1e-12);
  const S r = max(radius, tiny);
  const S b = sqrt(fma(bx, bx, by * by));
  S s = max(b / r - S(0.5) * (gxx + gyy), zero);
  S x, y;
  for (int i = 0; i < 3; ++i) {
    const S inverse_det = solve(s, x, y);
    const S n2 = fma(x, x, y * y);
    const S n = sqrt(n2);
    // t^T (G + s)^-1 t
    const S q = fma(x * x, gyy + s, fma(y * y, gxx + s, S(-2.0) * (gxy * (x * y)))) * inverse_det;
    const S step = ((n - r) * n2) / max(r * q, tiny * tiny);
    s = max(s + step, zero);
  }
  solve(s, x, y);
  // What Newton left is taken up radially, so that the bound holds exactly.
  const S scale = radius / max(sqrt(fma(x, x, y * y)), tiny);
  tx = select(slides, x * scale, tx);
  ty = select(slides, y * scale, ty);
}

/// Exact impulse of one hard contact: given b, its velocity without own impulse, finds lambda_n >=
/// 0 with v_n >= 0 and lambda_n v_n = 0, and lambda_t on the disc mu lambda_n. Friction changes the
/// normal velocity as much as the normal impulse does when a leg is steep (mu G_nt > G_nn), so that
/// treating the two in turn need not converge: here lambda_t/lambda_n is held while lambda_n is
/// solved for, until neither changes. `impulse`: start, result.
template <typename S>
inline void solve_hard(const Sym3<S>& g, const std::array<S, 3>& b, S friction, S tolerance,
                       std::array<S, 3>& impulse) noexcept {
  const S zero = S(0.0), tiny = S(1e-12);
  const Mask<S> closed = b[2] < zero;
  S n = max(impulse[2], zero);
  // Ratio of tangential to normal impulse: that of the start, or against the sliding velocity.
  const Mask<S> warm = n > tiny;
  const S speed = max(sqrt(fma(b[0], b[0], b[1] * b[1])), tiny);
  const S inverse_n = S(1.0) / max(n, tiny);
  S rx = select(warm, impulse[0] * inverse_n, -(friction * b[0]) / speed);
  S ry = select(warm, impulse[1] * inverse_n, -(friction * b[1]) / speed);
  S tx = zero, ty = zero;
  Mask<S> running = closed;
  constexpr int kMaxIterations = 12;
  for (int i = 0; i < kMaxIterations && any(running); ++i) {
    // A jammed contact (friction presses it in faster than the normal impulse lifts it) has no
    // sliding solution at this ratio; the floor lets lambda_n grow until the contact sticks.
    const S lift = max(fma(g.xz, rx, fma(g.yz, ry, g.zz)), S(0.1) * g.zz);
    const S next = -b[2] / lift;
    S x, y;
    solve_on_disc(g.xx, g.xy, g.yy, fma(g.xz, next, b[0]), fma(g.yz, next, b[1]), friction * next,
                  x, y);
    const Mask<S> settled = abs(next - n) < tolerance;
    n = select(running, next, n);
    tx = select(running, x, tx);
    ty = select(running, y, ty);
    const S inverse = S(1.0) / max(n, tiny);
    rx = select(running, tx * inverse, rx);
    ry = select(running, ty * inverse, ry);
    running = both(running, no(settled));
  }
  impulse = {select(closed, tx, zero), select(closed, ty, zero), select(closed, n, zero)};
}

/// Solves in place; `sum` comes back as the effect of all impulses. Returns the number of sweeps of
/// the slowest lane. Each lane stops once a sweep changed its impulses by less than `tolerance` (N
/// s) in sum.
template <typename S, int kPoints, int kStops>
inline int solve_contacts(std::array<PointContact<S>, kPoints>& points, int num_points,
                          std::array<StopRow<S>, kStops>& stops, int num_stops, S tolerance,
                          int max_sweeps, ImpulseSum<S>& sum) noexcept {
  sum = {};
  const S zero = S(0.0);
  for (int i = 0; i < num_points; ++i) {
    PointContact<S>& c = points[i];
    for (int r = 0; r < 3; ++r) {
      c.impulse[r] = select(c.active, c.impulse[r], zero);
      add_impulse(c.w[r], c.j[r], c.leg, c.impulse[r], sum);
    }
  }
  for (int i = 0; i < num_stops; ++i) {
    StopRow<S>& c = stops[i];
    c.impulse = select(c.active, c.impulse, zero);
    add_impulse(c.w, c.j, c.leg, c.impulse, sum);
  }
  Mask<S> running = zero == zero;
  int sweep = 0;
  while (sweep < max_sweeps) {
    ++sweep;
    S change = zero;
    for (int i = 0; i < num_stops; ++i) {
      StopRow<S>& c = stops[i];
      const S v = row_velocity(c.w, c.p, c.leg, c.free, sum);
      const S next = max(c.impulse - v / c.g, zero);
      const S d = select(both(running, c.active), next - c.impulse, zero);
      c.impulse = c.impulse + d;
      add_impulse(c.w, c.j, c.leg, d, sum);
      change = change + abs(d);
    }
    for (int i = 0; i < num_points; ++i) {
      PointContact<S>& c = points[i];
      const Mask<S> visit = both(running, c.active);
      if (!any(visit)) continue;
      const S vx = row_velocity(c.w[0], c.p[0], c.leg, c.free[0], sum);
      const S vy = row_velocity(c.w[1], c.p[1], c.leg, c.free[1], sum);
      const std::array<S, 3> before = c.impulse;
      // Velocity with this contact's tangential impulse taken away.
      const S bx = fma(-c.g.xx, before[0], fma(-c.g.xy, before[1], vx));
      const S by = fma(-c.g.xy, before[0], fma(-c.g.yy, before[1], vy));
      std::array<S, 3> next = before;
      const Mask<S> hard = both(visit, c.hard);
      if (any(no(hard))) solve_on_disc(c.g.xx, c.g.xy, c.g.yy, bx, by, c.disc, next[0], next[1]);
      if (any(hard)) {
        const S vz = row_velocity(c.w[2], c.p[2], c.leg, c.free[2], sum);
        const S bz = fma(-c.g.xz, before[0], fma(-c.g.yz, before[1], fma(-c.g.zz, before[2], vz)));
        std::array<S, 3> solved = before;
        solve_hard(c.g, {fma(-c.g.xz, before[2], bx), fma(-c.g.yz, before[2], by), bz}, c.friction,
                   S(0.1) * tolerance, solved);
        for (int r = 0; r < 3; ++r) next[r] = select(hard, solved[r], next[r]);
        const S dz = select(hard, next[2] - before[2], zero);
        c.impulse[2] = before[2] + dz;
        add_impulse(c.w[2], c.j[2], c.leg, dz, sum);
        change = change + abs(dz);
      }
      const S dx = select(visit, next[0] - before[0], zero);
      const S dy = select(visit, next[1] - before[1], zero);
      c.impulse[0] = before[0] + dx;
      c.impulse[1] = before[1] + dy;
      add_impulse(c.w[0], c.j[0], c.leg, dx, sum);
      add_impulse(c.w[1], c.j[1], c.leg, dy, sum);
      change = change + sqrt(fma(dx, dx, dy * dy));
    }
    running = both(running, change >= tolerance);
    if (!any(running)) break;
  }
  return sweep;
}

/// The paper's iteration (algorithm S1; constants of the authors' code): one projected gradient
/// step a visit, cold start, at most `max_sweeps` sweeps. For tests: slow.
template <typename S, int kPoints>
inline int solve_by_projection(std::array<PointContact<S>, kPoints>& points, int num_points,
                               S tolerance, int max_sweeps, ImpulseSum<S>& sum) noexcept {
  sum = {};
  for (int i = 0; i < num_points; ++i) {
    PointContact<S>& c = points[i];
    c.impulse[0] = c.impulse[1] = S(0.0);
    if (any(c.hard)) c.impulse[2] = S(0.0);
    if (any(c.active)) add_impulse(c.w[2], c.j[2], c.leg, c.impulse[2], sum);
  }
  for (int sweep = 1; sweep <= max_sweeps; ++sweep) {
    S change = S(0.0);
    for (int i = 0; i < num_points; ++i) {
      PointContact<S>& c = points[i];
      if (!any(c.active)) continue;
      std::array<S, 3> v;
      for (int r = 0; r < 3; ++r) v[r] = row_velocity(c.w[r], c.p[r], c.leg, c.free[r], sum);
      std::array<S, 3> next = c.impulse;
      S disc = c.disc;
      if (any(c.hard)) {
        next[2] = max(fma(S(-0.5) / c.g.zz, v[2], c.impulse[2]), S(0.0));
        disc = c.friction * next[2];
      }
      const S step = S(0.5) / max(c.g.xx, c.g.yy);
      next[0] = fma(-step, v[0], c.impulse[0]);
      next[1] = fma(-step, v[1], c.impulse[1]);
      const S n = sqrt(fma(next[0], next[0], next[1] * next[1]));
      const S scale = select(n > disc, disc / max(n, S(1e-30)), S(1.0));
      next[0] = next[0] * scale;
      next[1] = next[1] * scale;
      for (int r = 0; r < 3; ++r) add_impulse(c.w[r], c.j[r], c.leg, next[r] - c.impulse[r], sum);
      const S dx = next[0] - c.impulse[0], dy = next[1] - c.impulse[1];
      change = change + abs(next[2] - c.impulse[2]) + sqrt(fma(dx, dx, dy * dy));
      c.impulse = next;
    }
    if (!any(change >= tolerance)) return sweep;
  }
  return max_sweeps;
}

}  // namespace sandrunner::sim
