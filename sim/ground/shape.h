// SPDX-License-Identifier: BSD-3-Clause
// The shape of the undisturbed ground: a plane, level or sloped, and on it waves, dunes and heights
// from a file. It is the same for every law of force.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "rt/base/settings.h"
#include "sim/lanes/vec.h"

namespace sandrunner::sim {

class HeightGrid;

struct ShapeParameters {
  double slope_rad = 0.0;          ///< of the plane, whose height is 0 at the origin
  double slope_heading_rad = 0.0;  ///< uphill, from world x towards y
  double roughness_m = 0.0;        ///< standard deviation of the waves; 0: none
  double roughness_wavelength_m = 0.5;
  std::uint64_t roughness_seed = 1;
  double dune_height_m = 0.0;  ///< from trough to crest; 0: none
  double dune_length_m = 10.0;
  std::string heights_file;                   ///< of an ESRI ASCII grid; empty: none
  std::shared_ptr<const HeightGrid> heights;  ///< what is in it

  using P = ShapeParameters;
  static constexpr Setting<P> kSettings[] = {
      {"slope_deg", degrees(&P::slope_rad), 0.0, 45.0, "Angle of the ground; 0: level."},
      {"slope_heading_deg", degrees(&P::slope_heading_rad), -180.0, 180.0,
       "Where it is uphill: 0 along x, 90 along y."},
      {"roughness_m", &P::roughness_m, 0.0, 0.2,
       "Standard deviation of the ground's waves; 0: none."},
      {"roughness_wavelength_m", &P::roughness_wavelength_m, 0.05, 100.0,
       "Shortest wavelength of the waves."},
      {"roughness_seed", &P::roughness_seed, 0, 0x1p40, "Seed of the waves."},
      {"dune_height_m", &P::dune_height_m, 0.0, 3.0,
       "Height of dunes across x, from trough to crest; the origin is in a trough; 0: none."},
      {"dune_length_m", &P::dune_length_m, 1.0, 1000.0, "From one crest of the dunes to the next."},
      {"heights_file", &P::heights_file,
       "ESRI ASCII grid of heights in metres, whose middle lies at the origin, as found from the "
       "working directory; empty: none."},
  };
};

/// The surface at a point: height, m, and gradient. Zeros where it is level.
template <typename S>
struct Surface {
  S height{}, slope_x{}, slope_y{};
};

/// Axes of the contact frame: n is the surface's normal, t1 the tangent nearest to world x,
/// t2 = n x t1; all in the world frame.
template <typename S>
struct SurfaceAxes {
  Vec3<S> t1, t2, n;
};
template <typename S>
SurfaceAxes<S> surface_axes(const Surface<S>& surface) noexcept {
  const S one = S(1.0);
  const S &x = surface.slope_x, &y = surface.slope_y;
  const S n = one / sqrt(fma(x, x, fma(y, y, one)));
  const Vec3<S> normal{-(x * n), -(y * n), n};
  const S t = one / sqrt(fma(x, x, one));
  const Vec3<S> tangent{t, S(0.0), x * t};
  return {tangent, cross(normal, tangent), normal};
}

/// Constants of a shape. S: one robot, or a value per lane.
template <typename S>
struct Shape {
  S uneven{};                             ///< 0: the level plane at height 0; 1: any other shape
  S slope_x{}, slope_y{};                 ///< gradient of the plane
  S stretch = S(1.0);                     ///< of a length on the plane over its projection, uphill
  S crest{};                              ///< all stays below this height over the plane, m
  S roughness{}, wave_number{}, phase{};  ///< of the waves: m, rad/m, rad
  S dune{}, dune_number{};                ///< half the height of the dunes, m; rad/m

  /// Height over the plane, m.
  S over_plane(const Vec3<S>& p) const noexcept {
    return fma(-slope_x, p.x, fma(-slope_y, p.y, p.z));
  }
  /// Axes of the plane, along which FootMotion is measured on ground that is not level.
  SurfaceAxes<S> plane_axes() const noexcept {
    return surface_axes(Surface<S>{S(0.0), slope_x, slope_y});
  }
};

/// A body that stands square on the plane of a shape, towards world x. S: float or double.
template <typename S>
Quaternion<S> square_on(const Shape<S>& shape) noexcept {
  if (!(shape.stretch > S(1.0))) return {};
  const Vec3<S> n = shape.plane_axes().n;
  const S w = sqrt(S(0.5) * (S(1.0) + n.z)), half = S(0.5) / w;
  return {w, -n.y * half, n.x * half, S(0.0)};
}

Shape<double> derive_shape(const ShapeParameters& parameters);

/// Height (m) of the waves over the plane at (x, y) (world, m) and its gradient. Six plane waves
/// whose directions and phases follow from the seed: smooth, deterministic, and cheap in lanes.
template <typename S>
inline void rough_surface(const Shape<S>& shape, S x, S y, S& height, S& dx, S& dy) noexcept {
  // Directions 30 degrees apart and wave numbers up to the shortest wavelength; incommensurable, so
  // that the field does not repeat over a run.
  constexpr int kWaves = 6;
  constexpr double kCos[kWaves] = {1.0, 0.8660254037844386, 0.5, 0.0, -0.5, -0.8660254037844386};
  constexpr double kSin[kWaves] = {0.0, 0.5, 0.8660254037844386, 1.0, 0.8660254037844386, 0.5};
  constexpr double kScale[kWaves] = {1.0, 0.447, 0.812, 0.339, 0.667, 0.541};
  constexpr double kPhase[kWaves] = {0.0, 1.7, 3.1, 0.6, 4.4, 2.3};
  height = S(0.0);
  dx = S(0.0);
  dy = S(0.0);
  const S amplitude =
      shape.roughness * S(0.5773502691896258);  // sqrt(2/6): standard deviation of the sum
  for (int i = 0; i < kWaves; ++i) {
    const S kx = shape.wave_number * S(kCos[i] * kScale[i]);
    const S ky = shape.wave_number * S(kSin[i] * kScale[i]);
    S s, c;
    sincos(fma(kx, x, fma(ky, y, fma(shape.phase, S(1.0 + i), S(kPhase[i])))), s, c);
    height = fma(amplitude, s, height);
    const S slope = amplitude * c;
    dx = fma(slope, kx, dx);
    dy = fma(slope, ky, dy);
  }
}

/// The surface at (x, y), world, m.
template <typename S>
Surface<S> surface_at(const Shape<S>& shape, S x, S y) noexcept {
  const S zero = S(0.0);
  Surface<S> s;
  if (!any(shape.uneven > zero)) return s;
  const Mask<S> rough = shape.roughness > zero;
  if (any(rough)) {
    rough_surface(shape, x, y, s.height, s.slope_x, s.slope_y);
    s = {select(rough, s.height, zero), select(rough, s.slope_x, zero),
         select(rough, s.slope_y, zero)};
  }
  const Mask<S> dunes = shape.dune > zero;
  if (any(dunes)) {
    S sine, cosine;
    sincos(shape.dune_number * x, sine, cosine);
    s.height = select(dunes, s.height + shape.dune * (S(1.0) - cosine), s.height);
    s.slope_x = select(dunes, fma(shape.dune * shape.dune_number, sine, s.slope_x), s.slope_x);
  }
  return {fma(shape.slope_x, x, fma(shape.slope_y, y, s.height)), s.slope_x + shape.slope_x,
          s.slope_y + shape.slope_y};
}

}  // namespace sandrunner::sim
