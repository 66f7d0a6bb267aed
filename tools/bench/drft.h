// SPDX-License-Identifier: BSD-3-Clause
// Dynamic resistive force theory (DRFT), the peer against which the cone model of
// sim/ground/granular.h is timed: the force of granular ground on a rigid body as the sum over its
// surface elements that are below the surface and lead,
//   dF = (zeta |z| alpha - lambda rho v_n^2 n) dA,     leading: v_n = v . n > 0,
// z: depth of the element below the undisturbed surface, n: its outward normal, v: its velocity.
// The first term is resistive force theory, the second the momentum of the grains put in motion
// (Agarwal et al. 2021, lambda about 1.1). Their third term, the change of the free surface behind
// fast wheels, is left out: it vanishes for a foot that goes straight down.
//
// Two laws for alpha: Li, Zhang & Goldman 2013, motion in one vertical plane, as DRFT was
// published; and 3D-RFT (Agarwal, Goldman & Kamrin 2023), any motion in space, with a fully rough
// surface.
//
// Written for speed, as the model it is compared with: no angle is computed (the sines and cosines
// of the tilt and of the direction of motion are components of unit vectors), four elements at a
// time (one register of AVX, in double), and fours of which none leads below the surface cost only
// the test.
#pragma once

#include <span>
#include <vector>

#include "sim/lanes/vec.h"

namespace sandrunner::bench {

using Vector = sim::Vec3<double>;

struct DrftMedium {
  double stress_npm3 = 0.3e6;     ///< zeta: vertical stress per depth on a flat plate pushed down
  double density_kgpm3 = 1500.0;  ///< rho: of the bulk, not of the grains
  double inertia = 1.1;           ///< lambda; 0: quasistatic RFT
};

/// A piece of a body's surface, in the body's frame: x forward, y left, z up, origin at its centre.
struct SurfaceElement {
  Vector place_m, normal;
  double area_m2;
};

/// The rim of a cylinder that lies along y: `around` times `across` elements.
std::vector<SurfaceElement> cylinder_rim(double radius_m, double width_m, int around, int across);
/// One end of it, at +y or (side = -1) at -y: `rings` times `sectors` elements of the same area.
std::vector<SurfaceElement> cylinder_end(double radius_m, double width_m, int rings, int sectors,
                                         double side);

/// How a body moves; world axes, z up.
struct BodyMotion {
  double depth_m = 0.0;                                         ///< of its centre below the surface
  sim::Mat3<double> rotation{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< body to world
  Vector velocity_mps, spin_radps;
};

struct Wrench {
  Vector force_n, torque_nm;  ///< world axes, torque about the body's centre
};

/// A body's elements as arrays, padded to fours with elements of no area.
class SurfaceArrays {
 public:
  explicit SurfaceArrays(std::span<const SurfaceElement> elements);
  /// Elements, with padding.
  int size() const noexcept { return static_cast<int>(area_.size()); }
  double radius_m() const noexcept { return radius_; }

 protected:
  std::vector<double> x_, y_, z_, nx_, ny_, nz_, area_;
  double radius_;  ///< of the sphere about the centre that holds all elements
};

/// DRFT in a vertical plane. Only pitch, the x and z components of the velocity and the spin about
/// y are looked at; the rotation must be about y.
class PlanarDrft : public SurfaceArrays {
 public:
  using SurfaceArrays::SurfaceArrays;
  Wrench wrench(const DrftMedium& medium, const BodyMotion& motion) const noexcept;
};

/// DRFT in space.
class SpatialDrft : public SurfaceArrays {
 public:
  using SurfaceArrays::SurfaceArrays;
  Wrench wrench(const DrftMedium& medium, const BodyMotion& motion) const noexcept;
};

}  // namespace sandrunner::bench
