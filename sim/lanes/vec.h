// SPDX-License-Identifier: BSD-3-Clause
// Three-vectors and 3x3 matrices over one robot's scalar or a pack, with explicit fused operations.
#pragma once

#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

template <typename S>
struct Vec3 {
  S x{}, y{}, z{};
};

template <typename S>
inline Vec3<S> operator+(const Vec3<S>& a, const Vec3<S>& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename S>
inline Vec3<S> operator-(const Vec3<S>& a, const Vec3<S>& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename S>
inline Vec3<S> operator*(S a, const Vec3<S>& b) noexcept {
  return {a * b.x, a * b.y, a * b.z};
}
/// a s + b
template <typename S>
[[gnu::always_inline]] inline Vec3<S> mul_add(const Vec3<S>& a, S s, const Vec3<S>& b) noexcept {
  return {fma(a.x, s, b.x), fma(a.y, s, b.y), fma(a.z, s, b.z)};
}
template <typename S>
[[gnu::always_inline]] inline S dot(const Vec3<S>& a, const Vec3<S>& b) noexcept {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <typename S>
inline Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) noexcept {
  return {diff_of_products(a.y, b.z, a.z, b.y), diff_of_products(a.z, b.x, a.x, b.z),
          diff_of_products(a.x, b.y, a.y, b.x)};
}
/// a x b + c
template <typename S>
[[gnu::always_inline]] inline Vec3<S> cross_add(const Vec3<S>& a, const Vec3<S>& b,
                                                const Vec3<S>& c) noexcept {
  return {fma(a.y, b.z, fma(-a.z, b.y, c.x)), fma(a.z, b.x, fma(-a.x, b.z, c.y)),
          fma(a.x, b.y, fma(-a.y, b.x, c.z))};
}
template <typename S>
inline Vec3<S> select(const Mask<S>& m, const Vec3<S>& a, const Vec3<S>& b) noexcept {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// Three rows.
template <typename S>
struct Mat3 {
  Vec3<S> r0, r1, r2;
};
template <typename S>
[[gnu::always_inline]] inline Vec3<S> operator*(const Mat3<S>& m, const Vec3<S>& v) noexcept {
  return {dot(m.r0, v), dot(m.r1, v), dot(m.r2, v)};
}
/// m v + a
template <typename S>
inline Vec3<S> mul_add(const Mat3<S>& m, const Vec3<S>& v, const Vec3<S>& a) noexcept {
  return {fma(m.r0.x, v.x, fma(m.r0.y, v.y, fma(m.r0.z, v.z, a.x))),
          fma(m.r1.x, v.x, fma(m.r1.y, v.y, fma(m.r1.z, v.z, a.y))),
          fma(m.r2.x, v.x, fma(m.r2.y, v.y, fma(m.r2.z, v.z, a.z)))};
}
template <typename S>
inline Vec3<S> transposed_times(const Mat3<S>& m, const Vec3<S>& v) noexcept {
  return mul_add(m.r0, v.x, mul_add(m.r1, v.y, v.z * m.r2));
}
template <typename S>
inline Mat3<S> operator*(const Mat3<S>& a, const Mat3<S>& b) noexcept {
  return {transposed_times(b, a.r0), transposed_times(b, a.r1), transposed_times(b, a.r2)};
}

/// [dw]x + [w]x [w]x: times the position of a point, its acceleration on a body that turns at w.
template <typename S>
inline Mat3<S> turning_acceleration(const Vec3<S>& dw, const Vec3<S>& w) noexcept {
  const S xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
  const S xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
  return {{-(yy + zz), xy - dw.z, xz + dw.y},
          {xy + dw.z, -(xx + zz), yz - dw.x},
          {xz - dw.y, yz + dw.x, -(xx + yy)}};
}

/// Symmetric 3x3 matrix, such as an inertia.
template <typename S>
struct Sym3 {
  S xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
};
template <typename S>
inline Vec3<S> operator*(const Sym3<S>& m, const Vec3<S>& v) noexcept {
  return {fma(m.xx, v.x, fma(m.xy, v.y, m.xz * v.z)), fma(m.xy, v.x, fma(m.yy, v.y, m.yz * v.z)),
          fma(m.xz, v.x, fma(m.yz, v.y, m.zz * v.z))};
}
template <typename S>
inline Sym3<S> operator+(const Sym3<S>& a, const Sym3<S>& b) noexcept {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
/// i + m (|c|^2 1 - c c^T): inertia `i` of a body of mass m about its centre of mass, seen from
/// where that is at c.
template <typename S>
inline Sym3<S> shifted_inertia(const Sym3<S>& i, S m, const Vec3<S>& c) noexcept {
  const Vec3<S> mc = m * c;
  return {fma(mc.y, c.y, fma(mc.z, c.z, i.xx)),
          fma(-mc.x, c.y, i.xy),
          fma(-mc.x, c.z, i.xz),
          fma(mc.x, c.x, fma(mc.z, c.z, i.yy)),
          fma(-mc.y, c.z, i.yz),
          fma(mc.x, c.x, fma(mc.y, c.y, i.zz))};
}

/// Rotation about x by the angle whose sine and cosine are given: v -> Rx v, Rx^T v, Rx m Rx^T.
template <typename S>
inline Vec3<S> rotate_x(S s, S c, const Vec3<S>& v) noexcept {
  return {v.x, diff_of_products(c, v.y, s, v.z), fma(s, v.y, c * v.z)};
}
template <typename S>
inline Vec3<S> unrotate_x(S s, S c, const Vec3<S>& v) noexcept {
  return {v.x, fma(c, v.y, s * v.z), diff_of_products(c, v.z, s, v.y)};
}
template <typename S>
inline Sym3<S> rotate_x(S s, S c, const Sym3<S>& m) noexcept {
  // Columns of Rx m, then rows.
  const S ayy = diff_of_products(c, m.yy, s, m.yz), ayz = diff_of_products(c, m.yz, s, m.zz);
  const S azy = fma(s, m.yy, c * m.yz), azz = fma(s, m.yz, c * m.zz);
  return {m.xx,
          diff_of_products(c, m.xy, s, m.xz),
          fma(s, m.xy, c * m.xz),
          diff_of_products(c, ayy, s, ayz),
          fma(s, ayy, c * ayz),
          fma(s, azy, c * azz)};
}
/// Rotation about y.
template <typename S>
inline Vec3<S> rotate_y(S s, S c, const Vec3<S>& v) noexcept {
  return {fma(c, v.x, s * v.z), v.y, diff_of_products(c, v.z, s, v.x)};
}
template <typename S>
inline Sym3<S> rotate_y(S s, S c, const Sym3<S>& m) noexcept {
  const S axx = fma(c, m.xx, s * m.xz), axz = fma(c, m.xz, s * m.zz);
  const S azx = diff_of_products(c, m.xz, s, m.xx), azz = diff_of_products(c, m.zz, s, m.xz);
  return {fma(c, axx, s * axz),
          fma(c, m.xy, s * m.yz),
          diff_of_products(c, axz, s, axx),
          m.yy,
          diff_of_products(c, m.yz, s, m.xy),
          diff_of_products(c, azz, s, azx)};
}

/// Unit quaternion (w, x, y, z), rotation from body to world.
template <typename S>
struct Quaternion {
  S w = S(1.0), x{}, y{}, z{};
};
template <typename S>
inline Mat3<S> rotation_matrix(const Quaternion<S>& q) noexcept {
  const S two = S(2.0), one = S(1.0);
  const S x2 = q.x * two, y2 = q.y * two, z2 = q.z * two;
  const S wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  const S xx = q.x * x2, yy = q.y * y2, zz = q.z * z2;
  return {{one - (yy + zz), fma(q.x, y2, -wz), fma(q.x, z2, wy)},
          {fma(q.x, y2, wz), one - (xx + zz), fma(q.y, z2, -wx)},
          {fma(q.x, z2, -wy), fma(q.y, z2, wx), one - (xx + yy)}};
}
/// q (x) exp(w/2): turns q by the rotation vector w (rad) given in the body frame; the result is
/// normalised. |w| must be below 0.5 (an angular velocity of 2,000 rad/s for 0.25 ms): the series
/// are cut off.
template <typename S>
inline Quaternion<S> integrate(const Quaternion<S>& q, const Vec3<S>& w) noexcept {
  const S h = S(0.25) * dot(w, w);  // (|w|/2)^2
  // sin(a)/a and cos(a) with a^2 = h
  S sinc = fma(h, S(-1.0 / 5040.0), S(1.0 / 120.0));
  sinc = fma(h, sinc, S(-1.0 / 6.0));
  sinc = fma(h, sinc, S(1.0));
  S cosine = fma(h, S(-1.0 / 720.0), S(1.0 / 24.0));
  cosine = fma(h, cosine, S(-0.5));
  cosine = fma(h, cosine, S(1.0));
  const Vec3<S> v = (S(0.5) * sinc) * w;
  Quaternion<S> r;
  r.w = fma(q.w, cosine, -fma(q.x, v.x, fma(q.y, v.y, q.z * v.z)));
  r.x = fma(q.w, v.x, fma(q.x, cosine, diff_of_products(q.y, v.z, q.z, v.y)));
  r.y = fma(q.w, v.y, fma(q.y, cosine, diff_of_products(q.z, v.x, q.x, v.z)));
  r.z = fma(q.w, v.z, fma(q.z, cosine, diff_of_products(q.x, v.y, q.y, v.x)));
  const S n = sqrt(fma(r.w, r.w, fma(r.x, r.x, fma(r.y, r.y, r.z * r.z))));
  const S inverse = S(1.0) / n;
  return {r.w * inverse, r.x * inverse, r.y * inverse, r.z * inverse};
}

}  // namespace sandrunner::sim
