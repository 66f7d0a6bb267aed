// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/drft.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace sandrunner::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Four elements at a time, in the vectors of gcc and clang: one register of AVX, two of NEON.
using Four = double __attribute__((vector_size(32)));
using FourBits = std::int64_t __attribute__((vector_size(32)));  // of a comparison: all or none
constexpr int kWidth = 4;
inline Four all(double a) noexcept { return Four{a, a, a, a}; }
inline Four load(const std::vector<double>& a, int i) noexcept {
  Four four;
  std::memcpy(&four, a.data() + i, sizeof four);
  return four;
}
template <typename F>
inline Four each(const F& f) noexcept {
  Four four;
  for (int i = 0; i < kWidth; ++i) four[i] = f(i);
  return four;
}
inline Four fma(Four a, Four b, Four c) noexcept {
  return each([&](int i) { return std::fma(a[i], b[i], c[i]); });
}
inline Four fms(Four a, Four b, Four c) noexcept { return fma(a, b, -c); }
inline bool none(FourBits mask) noexcept { return (mask[0] | mask[1] | mask[2] | mask[3]) == 0; }
inline FourBits bits(Four a) noexcept { return reinterpret_cast<FourBits>(a); }
/// `a` where the mask is, else 0; `a` with the sign turned where `signs` has one.
inline Four where(FourBits mask, Four a) noexcept { return reinterpret_cast<Four>(mask & bits(a)); }
inline Four turned(Four a, FourBits signs) noexcept {
  return reinterpret_cast<Four>(bits(a) ^ signs);
}
// 1/|v| of the square of |v|; finite at 0, where the masks leave nothing to be multiplied by it.
inline Four inverse_root(Four square) noexcept {
  const Four least = all(1e-60), above = square > least ? square : least;
  return all(1.0) / each([&](int i) { return std::sqrt(above[i]); });
}
inline double sum(Four a) noexcept { return (a[0] + a[2]) + (a[1] + a[3]); }

// Li, Zhang & Goldman 2013, generic coefficients (zeta = 1), with beta the tilt of the element and
// gamma the angle of its velocity below the horizontal:
//   alpha_z = A00 + A10 cos 2b + B01 sin g + B11 sin(2b + g) + B-11 sin(-2b + g)
//   alpha_x = C01 cos g + C11 cos(2b + g) + C-11 cos(-2b + g) + D10 sin 2b
// Below, sums of angles are taken apart.
constexpr double kA00 = 0.206, kA10 = 0.169, kB11 = 0.212, kB01 = 0.358, kBm11 = 0.055;
constexpr double kC11 = -0.124, kC01 = 0.253, kCm11 = 0.007, kD10 = 0.088;

// 3D-RFT: f_i as a polynomial in x1 = sin g, x2 = cos b and x3 = n . v/|v|, in the order
//   1, x1, x2, x3, x1^2, x2^2, x3^2, x1 x2, x2 x3, x3 x1, x1^3, x2^3, x3^3, x1 x2^2, x2 x1^2,
//   x2 x3^2, x3 x2^2, x3 x1^2, x1 x3^2, x1 x2 x3.
using Coefficients = double[20];
constexpr Coefficients kF1 = {.00212,  -.02320, -.20890, -.43083, -.00259, .48872, -.00415,
                              .07204,  -.02750, -.08772, .01992,  -.45961, .40799, -.10107,
                              -.06576, .05664,  -.09269, .01892,  .01033,  .15120};
constexpr Coefficients kF2 = {-.06796, -.10941, .04725, -.06914, -.05835, -.65880, -.11985,
                              -.25739, -.26834, .02692, -.00736, .63758,  .08997,  .21069,
                              .04748,  .20406,  .18519, .04934,  .13527,  -.33207};
constexpr Coefficients kF3 = {-.02634, -.03436, .45256, .00835,  .02553, -1.31290, -.05532,
                              .06790,  -.16404, .02287, .02927,  .95406, -.00131,  -.11028,
                              .01487,  -.20770, .10911, -.04097, .07881, -.27519};
inline Four polynomial(const Coefficients& c, Four x1, Four x2, Four x3, Four x12, Four x23,
                       Four x31) noexcept {
  const auto k = [&](int i) { return all(c[i]); };
  const Four p1 = fma(x1, fma(x1, fma(x1, k(10), k(4)), k(1)), k(0));
  const Four p2 = x2 * fma(x2, fma(x2, k(11), k(5)), k(2));
  const Four p3 = fma(x3, fma(x3, fma(x3, k(12), k(6)), k(3)), p2);
  const Four p12 = fma(x2, k(13), fma(x1, k(14), fma(x3, k(19), k(7))));
  const Four p23 = fma(x3, k(15), fma(x2, k(16), k(8)));
  const Four p31 = fma(x1, k(17), fma(x3, k(18), k(9)));
  return fma(x12, p12, p1) + fma(x31, p31, fma(x23, p23, p3));
}

}  // namespace

std::vector<SurfaceElement> cylinder_rim(double radius_m, double width_m, int around, int across) {
  std::vector<SurfaceElement> elements;
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * kPi * (i + 0.5) / around;
    const Vector normal{std::cos(angle), 0.0, std::sin(angle)};
    for (int j = 0; j < across; ++j) {
      Vector place = radius_m * normal;
      place.y = width_m * ((j + 0.5) / across - 0.5);
      elements.push_back({place, normal, 2.0 * kPi * radius_m * width_m / (around * across)});
    }
  }
  return elements;
}

std::vector<SurfaceElement> cylinder_end(double radius_m, double width_m, int rings, int sectors,
                                         double side) {
  std::vector<SurfaceElement> elements;
  for (int i = 0; i < rings; ++i) {
    const double r = radius_m * std::sqrt((i + 0.5) / rings);
    for (int j = 0; j < sectors; ++j) {
      const double angle = 2.0 * kPi * (j + 0.5) / sectors;
      elements.push_back({{r * std::cos(angle), 0.5 * side * width_m, r * std::sin(angle)},
                          {0.0, side, 0.0},
                          kPi * radius_m * radius_m / (rings * sectors)});
    }
  }
  return elements;
}

SurfaceArrays::SurfaceArrays(std::span<const SurfaceElement> elements) : radius_(0.0) {
  const auto add = [&](const SurfaceElement& e) {
    x_.push_back(e.place_m.x);
    y_.push_back(e.place_m.y);
    z_.push_back(e.place_m.z);
    nx_.push_back(e.normal.x);
    ny_.push_back(e.normal.y);
    nz_.push_back(e.normal.z);
    area_.push_back(e.area_m2);
    radius_ = std::max(radius_, std::sqrt(sim::dot(e.place_m, e.place_m)));
  };
  for (const SurfaceElement& e : elements) add(e);
  while (area_.size() % kWidth != 0) add({{}, {}, 0.0});
}

Wrench PlanarDrft::wrench(const DrftMedium& medium, const BodyMotion& motion) const noexcept {
  if (motion.depth_m + radius_ <= 0.0) return {};
  const Four zero = all(0.0);
  const Four cosine = all(motion.rotation.r0.x), sine = all(motion.rotation.r0.z);
  const Four depth_of_centre = all(motion.depth_m), spin = all(motion.spin_radps.y);
  const Four vx = all(motion.velocity_mps.x), vz = all(motion.velocity_mps.z);
  const Four zeta = all(medium.stress_npm3), drag = all(medium.inertia * medium.density_kgpm3);
  Four force_x = zero, force_z = zero, torque = zero;
  for (int i = 0; i < size(); i += kWidth) {
    const Four bx = load(x_, i), bz = load(z_, i), bnx = load(nx_, i), bnz = load(nz_, i);
    const Four x = fma(cosine, bx, sine * bz), z = fms(cosine, bz, sine * bx);
    const Four nx = fma(cosine, bnx, sine * bnz), nz = fms(cosine, bnz, sine * bnx);
    const Four ux = fma(spin, z, vx), uz = fma(-spin, x, vz);
    const Four depth = depth_of_centre - z, vn = fma(ux, nx, uz * nz);
    const FourBits acts = (depth > zero) & (vn > zero);
    if (none(acts)) continue;
    const Four inverse = inverse_root(fma(ux, ux, uz * uz));
    const Four cos_g = ux * inverse, sin_g = -(uz * inverse);
    const Four cos_2b = fms(nz, nz, nx * nx), sin_2b = all(-2.0) * (nx * nz);
    const Four alpha_z =
        fma(cos_2b, fma(all(kB11 + kBm11), sin_g, all(kA10)),
            fma(all(kB11 - kBm11) * sin_2b, cos_g, fma(all(kB01), sin_g, all(kA00))));
    const Four alpha_x = fma(cos_g, fma(all(kC11 + kCm11), cos_2b, all(kC01)),
                             sin_2b * fma(all(kCm11 - kC11), sin_g, all(kD10)));
    const Four area = where(acts, load(area_, i));
    const Four stress = zeta * depth * area, momentum = drag * area * (vn * vn);
    const Four fx = -fma(stress, alpha_x, momentum * nx);
    const Four fz = fms(stress, alpha_z, momentum * nz);
    force_x += fx;
    force_z += fz;
    torque += fms(z, fx, x * fz);
  }
  return {{sum(force_x), 0.0, sum(force_z)}, {0.0, sum(torque), 0.0}};
}

Wrench SpatialDrft::wrench(const DrftMedium& medium, const BodyMotion& motion) const noexcept {
  if (motion.depth_m + radius_ <= 0.0) return {};
  // In the body's frame, so that no element has to be turned: `up` is the world's z there.
  const sim::Mat3<double>& r = motion.rotation;
  const Vector v = sim::transposed_times(r, motion.velocity_mps);
  const Vector w = sim::transposed_times(r, motion.spin_radps);
  const Four zero = all(0.0);
  const FourBits sign = bits(all(-0.0));
  const Four up_x = all(r.r2.x), up_y = all(r.r2.y), up_z = all(r.r2.z);
  const Four vx = all(v.x), vy = all(v.y), vz = all(v.z);
  const Four wx = all(w.x), wy = all(w.y), wz = all(w.z);
  const Four depth_of_centre = all(motion.depth_m);
  const Four zeta = all(medium.stress_npm3), drag = all(medium.inertia * medium.density_kgpm3);
  Four force_x = zero, force_y = zero, force_z = zero;
  Four torque_x = zero, torque_y = zero, torque_z = zero;
  for (int i = 0; i < size(); i += kWidth) {
    const Four x = load(x_, i), y = load(y_, i), z = load(z_, i);
    const Four nx = load(nx_, i), ny = load(ny_, i), nz = load(nz_, i);
    const Four depth = depth_of_centre - fma(up_x, x, fma(up_y, y, up_z * z));
    const Four ux = fma(wy, z, fma(-wz, y, vx));
    const Four uy = fma(wz, x, fma(-wx, z, vy));
    const Four uz = fma(wx, y, fma(-wy, x, vz));
    const Four vn = fma(ux, nx, fma(uy, ny, uz * nz));
    const FourBits acts = (depth > zero) & (vn > zero);
    if (none(acts)) continue;
    const Four inverse = inverse_root(fma(ux, ux, fma(uy, uy, uz * uz)));
    // alpha = f1 n' + f2 v/|v| - f3 up, n' the normal of the element's lower side.
    const Four n_up = fma(up_x, nx, fma(up_y, ny, up_z * nz));
    const FourBits flip = ~bits(n_up) & sign;
    const Four x1 = -(fma(up_x, ux, fma(up_y, uy, up_z * uz)) * inverse);
    const Four x2 = where(~sign, n_up);
    const Four x3 = turned(vn * inverse, flip);
    const Four x12 = x1 * x2, x23 = x2 * x3, x31 = x3 * x1;
    const Four f1 = turned(polynomial(kF1, x1, x2, x3, x12, x23, x31), flip);
    const Four f2 = polynomial(kF2, x1, x2, x3, x12, x23, x31);
    const Four f3 = polynomial(kF3, x1, x2, x3, x12, x23, x31);
    const Four area = where(acts, load(area_, i));
    const Four stress = zeta * depth * area;
    const Four along_n = fms(stress, f1, drag * area * (vn * vn));
    const Four along_v = stress * f2 * inverse, down = stress * f3;
    const Four fx = fma(along_n, nx, fms(along_v, ux, down * up_x));
    const Four fy = fma(along_n, ny, fms(along_v, uy, down * up_y));
    const Four fz = fma(along_n, nz, fms(along_v, uz, down * up_z));
    force_x += fx;
    force_y += fy;
    force_z += fz;
    torque_x += fms(y, fz, z * fy);
    torque_y += fms(z, fx, x * fz);
    torque_z += fms(x, fy, y * fx);
  }
  return {r * Vector{sum(force_x), sum(force_y), sum(force_z)},
          r * Vector{sum(torque_x), sum(torque_y), sum(torque_z)}};
}

}  // namespace sandrunner::bench
