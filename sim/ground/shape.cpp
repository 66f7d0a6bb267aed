// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/shape.h"

#include <cmath>
#include <numbers>

#include "rt/core/split_mix.h"
#include "sim/ground/height_grid.h"

namespace sandrunner::sim {

Shape<double> derive_shape(const ShapeParameters& p) {
  Shape<double> shape;
  if (p.slope_rad > 0.0) {
    double sine, cosine, heading_sine, heading_cosine;
    sincos(p.slope_rad, sine, cosine);
    sincos(p.slope_heading_rad, heading_sine, heading_cosine);
    shape.slope_x = sine / cosine * heading_cosine;
    shape.slope_y = sine / cosine * heading_sine;
    shape.stretch = 1.0 / cosine;
  }
  const bool plane = p.roughness_m == 0.0 && p.dune_height_m == 0.0 && !p.heights;
  shape.uneven = p.slope_rad > 0.0 || !plane ? 1.0 : 0.0;
  shape.roughness = p.roughness_m;
  // Six waves of amplitude roughness/sqrt(3) can add up to no more than this.
  shape.crest = p.roughness_m * 3.4641016151377544 + p.dune_height_m;
  if (p.heights) shape.crest += p.heights->crest_m();
  shape.dune = 0.5 * p.dune_height_m;
  shape.dune_number = 2.0 * std::numbers::pi / p.dune_length_m;
  shape.wave_number = 2.0 * std::numbers::pi / p.roughness_wavelength_m;
  // Spreads the seeds over [0, 2 pi).
  shape.phase = 2.0 * std::numbers::pi *
                static_cast<double>((p.roughness_seed * kGoldenRatio) >> 40) / 16777216.0;
  return shape;
}

}  // namespace sandrunner::sim
