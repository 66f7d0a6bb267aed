// SPDX-License-Identifier: BSD-3-Clause
// The contact problem of the paper ("Contact solver", algorithm S1): impulses of all contacts,
// coupled through the robot's inertia. Soft contacts (all grounds but hard ones) have a fixed
// normal impulse, which in mud may pull, and a friction disc of fixed radius; hard contacts have
// lambda_n >= 0, v_n >= 0, lambda_n v_n = 0 and a disc of radius mu lambda_n; in both the
// tangential velocity opposes the impulse where the disc is reached. Joint stops are one-sided rows
// of the same problem.
//
// The paper projects lambda_t - c_t v_t onto the disc, contact by contact, until an iteration
// changes less than 1e-5 N s. The fixed point is the same here, but each visit solves its contact
// exactly and starts from the last step's impulses, so that a few sweeps are enough.
#pragma once

#include <array>
#include <type_traits>

#include "sim/robot/dynamics.h"

namespace sandrunner::sim {

/// One contact point. Rows of the contact frame: two tangents, normal. J_b, J_l: its Jacobian by
/// base velocity (body components) and by the leg's joint rates; Y, M_ll, L, D as in Dynamics.
template <typename S>
struct PointContact {
  int leg = -1;                         ///< -1: on the base
  Mask<S> active{};                     ///< takes part
  Mask<S> hard{};                       ///< impenetrable; else the normal impulse is given
  S friction{};                         ///< hard: Coulomb's mu
  S disc{};                             ///< soft: radius of the friction disc, N s
  std::array<std::array<S, 6>, 3> w{};  ///< rows of (J_b - J_l Y) L^-T D^-1/2, kg^-1/2
  std::array<std::array<S, 3>, 3> j{};  ///< rows of J_l (per joint of the leg), m
  std::array<std::array<S, 3>, 3> p{};  ///< rows of J_l M_ll^-1, 1/(kg m)
  Sym3<S> g;                            ///< own 3x3 Delassus block, 1/kg
  std::array<S, 3> free{};              ///< velocity without any contact impulse, m/s
  std::array<S, 3> impulse{};           ///< N s; in: start; out: solution
};

/// A joint at its stop. The row's direction points away from the stop; w, j, p as in PointContact,
/// for a rate in rad/s in place of a velocity.
template <typename S>
struct StopRow {
  int leg = 0;
  Mask<S> active{};
  std::array<S, 6> w{};
  std::array<S, 3> j{};  ///< +-1 at the joint
  std::array<S, 3> p{};
  S g{};        ///< rad/s per N m s
  S free{};     ///< velocity without impulse, less the least velocity allowed, rad/s
  S impulse{};  ///< N m s
};

/// What the impulses do to the robot, in the square-root coordinates of Dynamics::half_solve and
/// per leg.
template <typename S>
struct ImpulseSum {
  std::array<S, 6> y{};                            ///< base, kg^1/2 m/s
  std::array<std::array<S, 3>, kNumLegs> joint{};  ///< N m s
};

/// Adds an impulse (N s, or N m s at a stop) along the row w, j of `leg` (-1: the base).
template <typename S>
inline void add_impulse(const std::array<S, 6>& w, const std::array<S, 3>& j, int leg, S impulse,
                        ImpulseSum<S>& sum) noexcept {
  for (int i = 0; i < 6; ++i) sum.y[i] = fma(w[i], impulse, sum.y[i]);
  if (leg < 0) return;
  for (int i = 0; i < 3; ++i) sum.joint[leg][i] = fma(j[i], impulse, sum.joint[leg][i]);
}

/// As above for the first `kRows` rows of a contact at once.
template <int kRows, typename S>
inline void add_impulses(const PointContact<S>& c, const std::array<S, std::size_t{kRows}>& impulse,
                         ImpulseSum<S>& sum) noexcept {
  for (int i = 0; i < 6; ++i) {
    S y = sum.y[i];
    for (int r = 0; r < kRows; ++r) y = fma(c.w[r][i], impulse[r], y);
    sum.y[i] = y;
  }
  if (c.leg < 0) return;
  for (int i = 0; i < 3; ++i) {
    S u = sum.joint[c.leg][i];
    for (int r = 0; r < kRows; ++r) u = fma(c.j[r][i], impulse[r], u);
    sum.joint[c.leg][i] = u;
  }
}

/// Velocity (m/s, or rad/s at a stop) along a row under all impulses; `free`: without any.
template <typename S>
inline S row_velocity(const std::array<S, 6>& w, const std::array<S, 3>& p, int leg, S free,
                      const ImpulseSum<S>& sum) noexcept {
  // The leg's part first: another leg's visit changes only y, so that this can be ready before.
  S a = free, b = w[1] * sum.y[1];
  if (leg >= 0) {
    a = fma(p[0], sum.joint[leg][0], fma(p[1], sum.joint[leg][1], fma(p[2], sum.joint[leg][2], a)));
  }
  a = fma(w[0], sum.y[0], a);
  a = fma(w[2], sum.y[2], a);
  b = fma(w[3], sum.y[3], b);
  a = fma(w[4], sum.y[4], a);
  b = fma(w[5], sum.y[5], b);
  return a + b;
}

/// Newton steps of solve_on_disc that reach rounding.
template <typename S>
inline constexpr int kDiscIterations = std::is_same_v<S, double> ? 3 : 2;

/// argmin 1/2 t^T G t + b^T t over the disc |t| <= radius (G 1/kg, b m/s, radius and t N s): the
/// tangential impulse whose velocity G t + b is zero inside the disc and opposes t on its rim. On
/// the rim t = -(G + s 1)^-1 b with s > 0 from Newton's iteration on 1/|t(s)| = 1/radius, which is
/// nearly linear in s. The start has G's Rayleigh quotient along b for G, exact where b is an
/// eigenvector; with the conditions that feet show (up to 2.3) the direction is then off by less
/// than 2e-3, 1e-6, 1e-12 after 1, 2, 3 steps. With adj and det of G + s 1, which are linear and
/// quadratic in s, t = -adj b / det needs no division on the way.
template <typename S>
inline void solve_on_disc(S gxx, S gxy, S gyy, S bx, S by, S radius, S& tx, S& ty,
                          int iterations = kDiscIterations<S>) noexcept {
  const S zero = S(0.0);
  const S det = diff_of_products(gxx, gyy, gxy, gxy), trace = gxx + gyy;
  // p = -adj(G) b
  const S px = diff_of_products(gxy, by, gyy, bx), py = diff_of_products(gxy, bx, gxx, by);
  const S p2 = fma(px, px, py * py), b2 = fma(bx, bx, by * by);
  const S inverse_det = S(1.0) / det, rim = radius * det;
  tx = px * inverse_det;
  ty = py * inverse_det;
  const Mask<S> slides = p2 > rim * rim;
  if (!any(slides)) return;
  const S tiny = S(1e-30);
  const S r = max(radius, S(1e-9));
  const S pb = -fma(px, bx, py * by);
  S s = max(sqrt(b2) * (S(1.0) / r) + (pb / max(b2, tiny) - trace), zero);
  for (int i = 0; i < iterations; ++i) {
    const S d = fma(s, s + trace, det), slope_d = fma(S(2.0), s, trace);
    // n = |p - s b|^2, and half its slope.
    const S slope_n = fma(s, b2, pb);
    const S n = fma(s, slope_n + pb, p2);
    const S curve = r * diff_of_products(n, slope_d, d, slope_n);
    const S step = (fma(-r, d, sqrt(n)) * n) / max(curve, tiny);
    s = max(s + step, zero);
  }
  const S x = fma(-s, bx, px), y = fma(-s, by, py);
  // Newton's remaining error is removed radially, so that the bound holds exactly.
  const S scale = radius / max(sqrt(fma(x, x, y * y)), tiny);
  tx = select(slides, x * scale, tx);
  ty = select(slides, y * scale, ty);
}

/// Exact impulse (N s, to `tolerance`) of one hard contact: given b, its velocity without own
/// impulse (m/s), finds lambda_n >= 0 with v_n >= 0 and lambda_n v_n = 0, and lambda_t on the disc
/// mu lambda_n whose velocity opposes it.
///
/// Friction changes the normal velocity as much as the normal impulse does when a leg is steep (mu
/// G_nt > G_nn), so that treating the two alternately may cycle. Here lambda(s) = -(G + s diag(1,
/// 1, 0))^-1 b has v_n = 0 and v_t = -s lambda_t for every s >= 0; s = 0 sticks, and if that lies
/// outside the cone, |lambda_t| - mu lambda_n has a root, bracketed by s = 0 (positive) and s =
/// infinity (negative). Anderson-Bjoerck iteration on u = s/(s + m), which maps the bracket to [0,
/// 1].
template <typename S>
inline void solve_hard(const Sym3<S>& g, const std::array<S, 3>& b, S friction, S tolerance,
                       std::array<S, 3>& impulse) noexcept {
  const S zero = S(0.0), one = S(1.0), tiny = S(1e-20);
  const Mask<S> closed = b[2] < zero;
  // Without lambda_n, which v_n = 0 gives: (A + s 1) lambda_t = -c.
  const S inverse_zz = one / g.zz;
  const S axx = fma(-(g.xz * g.xz), inverse_zz, g.xx);
  const S axy = fma(-(g.xz * g.yz), inverse_zz, g.xy);
  const S ayy = fma(-(g.yz * g.yz), inverse_zz, g.yy);
  const S lift = b[2] * inverse_zz;
  const S cx = fma(-g.xz, lift, b[0]), cy = fma(-g.yz, lift, b[1]);
  S x, y, n;
  // Impulse for s, and its excess over the cone.
  const auto excess = [&](S s) {
    const S a = axx + s, d = ayy + s;
    const S inverse_det = one / max(diff_of_products(a, d, axy, axy), tiny);
    x = diff_of_products(axy, cy, d, cx) * inverse_det;
    y = diff_of_products(axy, cx, a, cy) * inverse_det;
    n = -fma(fma(g.xz, x, g.yz * y), inverse_zz, lift);
    return fma(-friction, n, sqrt(fma(x, x, y * y)));
  };
  S f_low = excess(zero);
  const S f_start = f_low;
  S tx = x, ty = y, tn = n;
  const S scale = S(0.5) * (axx + ayy);
  S low = zero, high = one, f_high = friction * lift;
  Mask<S> running = both(closed, f_low > zero);
  constexpr int kMaxIterations = 30;
  for (int i = 0; i < kMaxIterations && any(running); ++i) {
    // The ends' values have opposite signs, so the quotient lies between them.
    const S u = fma(high - low, f_low / max(f_low - f_high, tiny), low);
    const S f = excess(scale * (u / max(one - u, tiny)));
    const Mask<S> outside = f > zero;
    // Anderson and Bjoerck (1973): the value of the end that stays shrinks as that of the other end
    // did, or is halved, so that it moves as well.
    const S shrunk = one - f / select(outside, f_low, f_high);
    const S kept = select(shrunk > zero, shrunk, S(0.5));
    const S next_low = select(outside, u, low), next_high = select(outside, high, u);
    const S next_f_low = select(outside, f, kept * f_low),
            next_f_high = select(outside, kept * f_high, f);
    tx = select(running, x, tx);
    ty = select(running, y, ty);
    tn = select(running, n, tn);
    low = select(running, next_low, low);
    high = select(running, next_high, high);
    f_low = select(running, next_f_low, f_low);
    f_high = select(running, next_f_high, f_high);
    running = both(running, abs(f) >= tolerance);
  }
  // The iteration's remaining error is removed radially: a sliding impulse lies on the cone.
  const Mask<S> slides = f_start > zero;
  const S size = sqrt(fma(tx, tx, ty * ty));
  const S to_cone = select(slides, (friction * tn) / max(size, tiny), one);
  impulse = {select(closed, tx * to_cone, zero), select(closed, ty * to_cone, zero),
             select(closed, max(tn, zero), zero)};
}

/// One visit of the paper's iteration (algorithm S1, constants of the authors' code): a gradient
/// step of half the contact's own curvature, projected onto lambda_n >= 0 and the friction disc. v:
/// velocity with all impulses, m/s. Returns the contact's next impulse, N s.
template <typename S>
inline std::array<S, 3> projected_step(const PointContact<S>& c, const Mask<S>& hard, S vx, S vy,
                                       S vz) noexcept {
  const S normal = max(fma(S(-0.5) / c.g.zz, vz, c.impulse[2]), S(0.0));
  const S disc = select(hard, c.friction * normal, c.disc);
  const S step = S(0.5) / max(c.g.xx, c.g.yy);
  const S x = fma(-step, vx, c.impulse[0]), y = fma(-step, vy, c.impulse[1]);
  const S n = sqrt(fma(x, x, y * y));
  const S scale = select(n > disc, disc / max(n, S(1e-30)), S(1.0));
  return {x * scale, y * scale, select(hard, normal, c.impulse[2])};
}

/// Sweeps with exact visits, before the paper's projected steps take over: exact visits one after
/// the other can cycle where a soft foot and a hard knee share a leg, the paper's shorter steps do
/// not.
inline constexpr int kExactSweeps = 50;

/// Solves in place; `sum` comes back as the effect of all impulses. Returns the number of sweeps of
/// the slowest lane. Each lane stops once a sweep other than its first changed its impulses by less
/// than `tolerance` (N s) in sum, or the next one can be expected to: where only feet touch, the
/// changes shrink to a hundredth from sweep to sweep.
template <typename S, int kPoints, int kStops>
inline int solve_contacts(std::array<PointContact<S>, kPoints>& points, int num_points,
                          std::array<StopRow<S>, kStops>& stops, int num_stops, S tolerance,
                          int max_sweeps, ImpulseSum<S>& sum) noexcept {
  sum = {};
  const S zero = S(0.0);
  for (int i = 0; i < num_points; ++i) {
    PointContact<S>& c = points[i];
    for (int r = 0; r < 3; ++r) c.impulse[r] = select(c.active, c.impulse[r], zero);
    add_impulses<3>(c, c.impulse, sum);
  }
  for (int i = 0; i < num_stops; ++i) {
    StopRow<S>& c = stops[i];
    c.impulse = select(c.active, c.impulse, zero);
    add_impulse(c.w, c.j, c.leg, c.impulse, sum);
  }
  Mask<S> running = every_lane<S>();
  S last_change = zero;
  const S enough = S(0.3) * tolerance;  // of the change expected: they do not shrink evenly
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
      if (sweep > kExactSweeps) {
        const S vz = row_velocity(c.w[2], c.p[2], c.leg, c.free[2], sum);
        next = projected_step(c, hard, vx, vy, vz);
      } else {
        if (any(no(hard))) {
          // The second sweep solves this again: Newton's starting point is good enough here.
          solve_on_disc(c.g.xx, c.g.xy, c.g.yy, bx, by, c.disc, next[0], next[1],
                        sweep == 1 ? 0 : kDiscIterations<S>);
        }
        if (any(hard)) {
          const S vz = row_velocity(c.w[2], c.p[2], c.leg, c.free[2], sum);
          const S bz =
              fma(-c.g.xz, before[0], fma(-c.g.yz, before[1], fma(-c.g.zz, before[2], vz)));
          std::array<S, 3> solved = before;
          solve_hard(c.g, {fma(-c.g.xz, before[2], bx), fma(-c.g.yz, before[2], by), bz},
                     c.friction, S(0.01) * tolerance, solved);
          for (int r = 0; r < 3; ++r) next[r] = select(hard, solved[r], next[r]);
        }
      }
      if (any(hard)) {
        const S dz = select(hard, next[2] - before[2], zero);
        c.impulse[2] = before[2] + dz;
        add_impulse(c.w[2], c.j[2], c.leg, dz, sum);
        change = change + abs(dz);
      }
      const S dx = select(visit, next[0] - before[0], zero);
      const S dy = select(visit, next[1] - before[1], zero);
      c.impulse[0] = before[0] + dx;
      c.impulse[1] = before[1] + dy;
      add_impulses<2>(c, {dx, dy}, sum);
      change = change + sqrt(fma(dx, dx, dy * dy));
    }
    if (sweep > 1) {
      const Mask<S> more = change * change > enough * last_change;
      running = both(running, both(change >= tolerance, more));
    }
    last_change = change;
    if (!any(running)) break;
  }
  return sweep;
}

}  // namespace sandrunner::sim
