// SPDX-License-Identifier: BSD-3-Clause
// What one patch of ground is made of: the parameters a person writes (SI units, sigma in N/m^3),
// and the constants derived from them that the contact law uses at every step.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>

#include "sim/ground/foot_profile.h"
#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

enum class GroundKind : std::uint32_t { kGranular, kRigid, kLinear };

/// Parameters of a patch of ground. Defaults are those of the paper authors' code for its sand
/// demonstration. Symbols as in Aguilar & Goldman 2016 as generalised by the paper (section S11)
/// and its HSR model (eqs. 1, 2).
struct GroundParameters {
  GroundKind kind = GroundKind::kGranular;
  double friction = 0.8;  ///< Coulomb coefficient foot-ground

  // Granular: developing cone.
  double sigma_flat_npm3 = 1.0e6;              ///< stress gradient on the flat face
  double sigma_cone_npm3 = 0.2e6;              ///< stress gradient on the cone's side
  double recruitment = 2.0;                    ///< nu: cone height gained per depth
  double cone_angle_rad = 1.0471975511965976;  ///< theta, from the horizontal
  double mass_scaling = 2.7;                   ///< c_g: grains moved outside the cone
  double packing = 0.57;                       ///< phi: volume fraction
  double grain_density_kgpm3 = 1000.0;         ///< rho
  double drag = 17.2;                          ///< c_d: inertial drag scaling
  double plastic_tolerance_m = 1e-4;           ///< eps_f
  // Granular: horizontal stroke resistance.
  double stroke_stiffness_npm = 160.0;           ///< k_h
  double stroke_damping_nspm = 1.0;              ///< b_h
  double stroke_depth_scaling = 0.5;             ///< beta_d
  double crater_radius_m = 0.05;                 ///< r_c
  double crater_angle_rad = 0.7853981633974483;  ///< gamma_c

  // Effects of the granular model, each of which can be switched off for an ablation.
  bool inertial_drag = true;  ///< c_d m_a' z_dot
  bool added_mass = true;     ///< m_a z_ddot
  bool plastic_memory =
      true;  ///< force only beyond the remembered depth (else whenever the foot goes down)
  bool healing = true;  ///< the remembered depth heals as the foot moves sideways
  bool filter = true;   ///< moving average of the normal force (eq. S16)
  bool stroke_resistance = true;
  bool gated_friction =
      false;  ///< friction only while the normal force acts (authors' code: always)

  // Linear: spring and damper.
  double stiffness_npm = 10.0e3;  ///< k_s
  double damping_nspm = 200.0;    ///< b_s
  /// k_c: feet on such ground share one pressure. Its force on each of them is k_c times the sum of
  /// their depths, from the energy k_c/2 (sum of depths)^2.
  double coupling_npm = 0.0;

  // Rigid: uneven height field of this standard deviation and shortest wavelength; 0: flat.
  double roughness_m = 0.0;
  double roughness_wavelength_m = 0.5;
  std::uint64_t roughness_seed = 1;
};

/// Constants of one patch, derived once from GroundParameters, whose symbols and units they keep
/// (N/m^3, N/m, N s/m, m; ratios without unit). S: one robot, or a value per lane.
template <typename S>
struct Ground {
  S is_granular{}, is_rigid{}, is_linear{};  ///< exactly one of them is 1
  S friction{};
  S sigma_flat{}, sigma_cone{};  ///< N/m^3
  S k{};                         ///< nu / tan(theta)
  S k2_third{};                  ///< k^2/3
  S inverse_cos{};               ///< 1/cos(theta)
  S full_depth{};                ///< z_c, at which the lower flat has vanished, m
  S full_flat{};                 ///< I_flat(z_c), m^3
  S added_mass{};                ///< c_g phi rho nu (per I_flat), kg/m^3; 0: no added mass
  S drag{};                      ///< c_d c_g phi rho nu (per A_flat), kg/m^3; 0: no drag
  S memory{};                    ///< 1: plastic memory, 0: none
  S tolerance{};                 ///< eps_f, m
  S healing_slope{};             ///< tan(gamma_c), 0: no healing
  S crater_radius{};             ///< r_c, m
  S filter_step{};               ///< c_r, what tau_r gains at a reversal; 0: no filter
  S friction_gated{};            ///< 1: friction only while the normal force acts
  S stroke_stiffness{}, stroke_damping{}, stroke_depth_scaling{};  ///< k_h, b_h, beta_d
  S stroke_offset{};  ///< r_f/sin(gamma_c) - r_c - r_f/tan(gamma_c), m
  S inverse_tan_crater{};
  S stiffness{}, damping{};  ///< k_s, b_s
  S coupling{};  ///< sqrt(k_c), so that feet on patches with different k_c share an energy too
  S roughness{}, wave_number{}, phase{};  ///< m, rad/m, rad
};

/// Cone integrals at depth z (m) of a foot with the given P0, P1 (m^3; see FootProfile).
template <typename S>
struct Cone {
  S flat_integral;  ///< I_flat, m^3
  S cone_integral;  ///< I_cone, m^3
};
template <typename S>
inline Cone<S> cone_integrals(const Ground<S>& g, S z, S p0, S p1) noexcept {
  const S pi = S(std::numbers::pi);
  // pi (P0 - 2 k P1 + k^2 z^3 / 3)
  const S growing = pi * fma(z * (z * z), g.k2_third, fma(S(-2.0) * g.k, p1, p0));
  const S flat = select(z < g.full_depth, growing, g.full_flat);
  return {flat, fma(pi, p0, -flat) * g.inverse_cos};
}
/// Area of the lower flat at depth z, m^2: pi max(0, r_h - k z)^2.
template <typename S>
inline S flat_area(const Ground<S>& g, S z, S hydraulic_radius) noexcept {
  const S r = max(fma(-g.k, z, hydraulic_radius), S(0.0));
  return S(std::numbers::pi) * (r * r);
}
/// Quasistatic force F_p = sigma_flat I_flat + sigma_cone I_cone, N.
template <typename S>
inline S quasistatic_force(const Ground<S>& g, const Cone<S>& c) noexcept {
  return fma(g.sigma_flat, c.flat_integral, g.sigma_cone * c.cone_integral);
}
/// The same at depth z >= 0 of a foot.
template <typename S>
inline S quasistatic_force(const Ground<S>& g, const FootProfile<S>& foot, S z) noexcept {
  S p0, p1;
  foot.integrals(z, p0, p1);
  return quasistatic_force(g, cone_integrals(g, z, p0, p1));
}

/// Derives the constants for a foot. `foot_radius_m` is the r_f of the HSR model.
Ground<double> derive_ground(const GroundParameters& parameters, const FootProfile<double>& foot,
                             double foot_radius_m);

/// Height (m) of the uneven rigid surface at (x, y) (world, m) and its gradient; 0 for ground
/// without roughness.
/// Six plane waves whose directions and phases follow from the seed: smooth, deterministic, and
/// cheap in lanes.
template <typename S>
inline void rough_surface(const Ground<S>& g, S x, S y, S& height, S& dx, S& dy) noexcept {
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
      g.roughness * S(0.5773502691896258);  // sqrt(2/6): standard deviation of the sum
  for (int i = 0; i < kWaves; ++i) {
    const S kx = g.wave_number * S(kCos[i] * kScale[i]);
    const S ky = g.wave_number * S(kSin[i] * kScale[i]);
    S s, c;
    sincos(fma(kx, x, fma(ky, y, fma(g.phase, S(1.0 + i), S(kPhase[i])))), s, c);
    height = fma(amplitude, s, height);
    const S slope = amplitude * c;
    dx = fma(slope, kx, dx);
    dy = fma(slope, ky, dy);
  }
}

}  // namespace sandrunner::sim
