// SPDX-License-Identifier: BSD-3-Clause
// The vocabulary in which the simulator's step is written once, for one robot (double, float) and
// for a SIMD pack with a robot in every lane. A data-dependent choice is a `select` under a mask,
// never a branch; the only branches are `if (any(mask))` around work that is a bitwise no-op for
// the lanes outside the mask. Fused operations are explicit, so that all widths and compilers give
// the same bits.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "rt/core/fma.h"

namespace sandrunner::sim {

/// Type of a comparison of two S: bool for one robot, a lane mask for a pack.
template <typename S>
struct MaskOf {
  using type = bool;
};
template <typename S>
using Mask = typename MaskOf<S>::type;

using sandrunner::fma;
inline double sqrt(double a) noexcept { return std::sqrt(a); }
inline float sqrt(float a) noexcept { return std::sqrt(a); }
inline double floor(double a) noexcept { return std::floor(a); }
inline float floor(float a) noexcept { return std::floor(a); }
inline double abs(double a) noexcept { return std::fabs(a); }
inline float abs(float a) noexcept { return std::fabs(a); }

// As the x86 instructions do it: the second operand where neither is smaller (larger).
inline double min(double a, double b) noexcept { return a < b ? a : b; }
inline float min(float a, float b) noexcept { return a < b ? a : b; }
inline double max(double a, double b) noexcept { return a > b ? a : b; }
inline float max(float a, float b) noexcept { return a > b ? a : b; }

inline double select(bool m, double a, double b) noexcept { return m ? a : b; }
inline float select(bool m, float a, float b) noexcept { return m ? a : b; }
inline bool any(bool m) noexcept { return m; }
inline bool both(bool a, bool b) noexcept { return a && b; }
inline bool either(bool a, bool b) noexcept { return a || b; }
inline bool no(bool a) noexcept { return !a; }

inline void load(const double* from, double& to) noexcept { to = *from; }
inline void store(double from, double* to) noexcept { *to = from; }

/// The mask of all lanes.
template <typename S>
inline Mask<S> every_lane() noexcept {
  const S zero = S(0.0);
  return zero == zero;  // one register. NOLINT(misc-redundant-expression)
}

/// a b - c d with one rounding less than two products.
template <typename S>
inline S diff_of_products(S a, S b, S c, S d) noexcept {
  return fma(a, b, -(c * d));
}

template <typename S>
inline constexpr bool kIsDouble = std::is_same_v<S, double>;

/// A scalar of S, and those of all lanes, as std::bit_cast takes them out of it: for what has no
/// code for packs.
template <typename S>
using LaneScalar = std::conditional_t<std::is_floating_point_v<S>, S, float>;
template <typename S>
using LaneValues = std::array<LaneScalar<S>, sizeof(S) / sizeof(LaneScalar<S>)>;  // NOLINT

/// to = from in the lanes of `m`. T: all of its members are S. One after the other in place:
/// std::bit_cast of a large T copies it.
template <typename S, typename T>
inline void assign_where(const Mask<S>& m, const T& from, T& to) noexcept {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(S) == 0);
  for (std::size_t at = 0; at < sizeof(T); at += sizeof(S)) {
    S a, b;
    std::memcpy(&a, reinterpret_cast<const char*>(&from) + at, sizeof(S));
    std::memcpy(&b, reinterpret_cast<const char*>(&to) + at, sizeof(S));
    const S chosen = select(m, a, b);
    std::memcpy(reinterpret_cast<char*>(&to) + at, &chosen, sizeof(S));
  }
}

/// The same in another scalar. T: all of its members are S.
template <typename To, template <typename> typename T>
inline T<To> converted(const T<double>& from) noexcept {
  const auto values = std::bit_cast<std::array<double, sizeof(from) / sizeof(double)>>(from);
  std::array<To, values.size()> to;
  for (std::size_t i = 0; i < values.size(); ++i) to[i] = To(values[i]);
  return std::bit_cast<T<To>>(to);
}

/// e^x for 0 <= x <= 7: the Taylor series of x/16, squared four times. Relative error below 2e-6 in
/// float, 1e-14 in double. Own code because libm's bits depend on the machine.
template <typename S>
inline S exponential(S x) noexcept {
  const S part = S(1.0 / 16.0) * x;
  S e = S(1.0);
  for (int n = kIsDouble<S> ? 15 : 7; n > 0; --n) e = fma(part * S(1.0 / n), e, S(1.0));
  for (int i = 0; i < 4; ++i) e = e * e;
  return e;
}

/// Sine and cosine for |x| < 1e4 (Cody-Waite reduction to +-pi/4, then the polynomials of Cephes:
/// float; fdlibm: double). Error below 2.5 ulp in double, 1e-7 in float. Own code because libm's
/// bits depend on the machine.
template <typename S>
inline void sincos(S x, S& sine, S& cosine) noexcept {
  const S k = floor(fma(x, S(0.63661977236758134308), S(0.5)));
  S r, s, c;
  if constexpr (kIsDouble<S>) {
    r = fma(k, S(-1.5707963267341256e+00), x);
    r = fma(k, S(-6.07710050630396597660e-11), r);
    r = fma(k, S(-2.0222662487959506e-21), r);
    const S z = r * r;
    S p = fma(z, S(1.58969099521155010221e-10), S(-2.50507602534068634195e-08));
    p = fma(z, p, S(2.75573137070700676789e-06));
    p = fma(z, p, S(-1.98412698298579493134e-04));
    p = fma(z, p, S(8.33333333332248946124e-03));
    p = fma(z, p, S(-1.66666666666666324348e-01));
    s = fma(r * z, p, r);
    S q = fma(z, S(-1.13596475577881948265e-11), S(2.08757232129817482790e-09));
    q = fma(z, q, S(-2.75573143513906633035e-07));
    q = fma(z, q, S(2.48015872894767294178e-05));
    q = fma(z, q, S(-1.38888888888741095749e-03));
    q = fma(z, q, S(4.16666666666666019037e-02));
    c = fma(z * z, q, fma(z, S(-0.5), S(1.0)));
  } else {
    r = fma(k, S(-1.5707963705062866f), x);
    r = fma(k, S(4.371139000186241e-08f), r);
    const S z = r * r;
    S p = fma(z, S(-1.9515295891e-4f), S(8.3321608736e-3f));
    p = fma(z, p, S(-1.6666654611e-1f));
    s = fma(r * z, p, r);
    S q = fma(z, S(2.443315711809948e-5f), S(-1.388731625493765e-3f));
    q = fma(z, q, S(4.166664568298827e-2f));
    c = fma(z * z, q, fma(z, S(-0.5f), S(1.0f)));
  }
  // Quadrant k mod 4: odd ones swap sine and cosine; signs follow.
  const S quadrant = fma(floor(k * S(0.25)), S(-4.0), k);
  const Mask<S> odd = either(quadrant == S(1.0), quadrant == S(3.0));
  const S sin_part = select(odd, c, s);
  const S cos_part = select(odd, s, c);
  sine = select(quadrant >= S(2.0), -sin_part, sin_part);
  cosine = select(either(quadrant == S(1.0), quadrant == S(2.0)), -cos_part, cos_part);
}

}  // namespace sandrunner::sim
