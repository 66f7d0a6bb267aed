// SPDX-License-Identifier: BSD-3-Clause
// SIMD packs of float with a robot in every lane: the pack counterpart of lanes.h. On x86-64
// Pack<8> needs AVX2 and FMA (x86-64-v3), Pack<16> AVX-512 (x86-64-v4) and exists only in sources
// compiled for it.
//
// Every operation is the IEEE one of the scalar code, lane by lane, so that a robot's trajectory
// has the same bits in any lane of any width.
#pragma once

#ifdef __aarch64__
#include "sim/lanes/pack_neon.h"
#else
#include <immintrin.h>

#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

template <int kLanes>
struct Pack;
template <int kLanes>
struct PackMask;

template <int kLanes>
struct MaskOf<Pack<kLanes>> {
  using type = PackMask<kLanes>;
};

template <>
struct PackMask<8> {
  __m256 bits;
};

template <>
struct alignas(32) Pack<8> {
  using Element = float;
  static constexpr int kWidth = 8;
  __m256 v;
  Pack() = default;
  // Implicit: the operators below return what the intrinsics do.
  Pack(__m256 lanes) noexcept : v(lanes) {}  // NOLINT(google-explicit-constructor)
  explicit Pack(float x) noexcept : v(_mm256_set1_ps(x)) {}
  explicit Pack(double x) noexcept : Pack(static_cast<float>(x)) {}
};

inline Pack<8> operator+(Pack<8> a, Pack<8> b) noexcept { return _mm256_add_ps(a.v, b.v); }
inline Pack<8> operator-(Pack<8> a, Pack<8> b) noexcept { return _mm256_sub_ps(a.v, b.v); }
inline Pack<8> operator*(Pack<8> a, Pack<8> b) noexcept { return _mm256_mul_ps(a.v, b.v); }
inline Pack<8> operator/(Pack<8> a, Pack<8> b) noexcept { return _mm256_div_ps(a.v, b.v); }
inline Pack<8> operator-(Pack<8> a) noexcept { return -a.v; }
inline Pack<8> fma(Pack<8> a, Pack<8> b, Pack<8> c) noexcept {
  return _mm256_fmadd_ps(a.v, b.v, c.v);
}
inline Pack<8> sqrt(Pack<8> a) noexcept { return _mm256_sqrt_ps(a.v); }
inline Pack<8> floor(Pack<8> a) noexcept { return _mm256_floor_ps(a.v); }
inline Pack<8> abs(Pack<8> a) noexcept { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
inline Pack<8> min(Pack<8> a, Pack<8> b) noexcept { return _mm256_min_ps(a.v, b.v); }
inline Pack<8> max(Pack<8> a, Pack<8> b) noexcept { return _mm256_max_ps(a.v, b.v); }
inline PackMask<8> operator<(Pack<8> a, Pack<8> b) noexcept {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)};
}
inline PackMask<8> operator>(Pack<8> a, Pack<8> b) noexcept {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ)};
}
inline PackMask<8> operator>=(Pack<8> a, Pack<8> b) noexcept {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ)};
}
inline PackMask<8> operator==(Pack<8> a, Pack<8> b) noexcept {
  return {_mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ)};
}
inline PackMask<8> both(PackMask<8> a, PackMask<8> b) noexcept {
  return {_mm256_and_ps(a.bits, b.bits)};
}
inline PackMask<8> either(PackMask<8> a, PackMask<8> b) noexcept {
  return {_mm256_or_ps(a.bits, b.bits)};
}
inline PackMask<8> no(PackMask<8> a) noexcept {
  return {_mm256_xor_ps(a.bits, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))};
}
inline bool any(PackMask<8> m) noexcept { return _mm256_movemask_ps(m.bits) != 0; }
inline Pack<8> select(PackMask<8> m, Pack<8> a, Pack<8> b) noexcept {
  return _mm256_blendv_ps(b.v, a.v, m.bits);
}
/// 2^n for whole n from -126 to 127.
inline Pack<8> two_to(Pack<8> n) noexcept {
  const __m256i exponent = _mm256_add_epi32(_mm256_cvtps_epi32(n.v), _mm256_set1_epi32(127));
  return _mm256_castsi256_ps(_mm256_slli_epi32(exponent, 23));
}
inline void load(const float* from, Pack<8>& to) noexcept { to.v = _mm256_loadu_ps(from); }
inline void store(Pack<8> from, float* to) noexcept { _mm256_storeu_ps(to, from.v); }

#ifdef __AVX512F__
template <>
struct PackMask<16> {
  __mmask16 bits;
};

template <>
struct alignas(64) Pack<16> {
  using Element = float;
  static constexpr int kWidth = 16;
  __m512 v;
  Pack() = default;
  Pack(__m512 lanes) noexcept : v(lanes) {}  // NOLINT(google-explicit-constructor)
  explicit Pack(float x) noexcept : v(_mm512_set1_ps(x)) {}
  explicit Pack(double x) noexcept : Pack(static_cast<float>(x)) {}
};

inline Pack<16> operator+(Pack<16> a, Pack<16> b) noexcept { return _mm512_add_ps(a.v, b.v); }
inline Pack<16> operator-(Pack<16> a, Pack<16> b) noexcept { return _mm512_sub_ps(a.v, b.v); }
inline Pack<16> operator*(Pack<16> a, Pack<16> b) noexcept { return _mm512_mul_ps(a.v, b.v); }
inline Pack<16> operator/(Pack<16> a, Pack<16> b) noexcept { return _mm512_div_ps(a.v, b.v); }
inline Pack<16> operator-(Pack<16> a) noexcept { return -a.v; }
inline Pack<16> fma(Pack<16> a, Pack<16> b, Pack<16> c) noexcept {
  return _mm512_fmadd_ps(a.v, b.v, c.v);
}
inline Pack<16> sqrt(Pack<16> a) noexcept { return _mm512_sqrt_ps(a.v); }
inline Pack<16> floor(Pack<16> a) noexcept {
  return _mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
inline Pack<16> abs(Pack<16> a) noexcept { return _mm512_abs_ps(a.v); }
inline Pack<16> min(Pack<16> a, Pack<16> b) noexcept { return _mm512_min_ps(a.v, b.v); }
inline Pack<16> max(Pack<16> a, Pack<16> b) noexcept { return _mm512_max_ps(a.v, b.v); }
inline PackMask<16> operator<(Pack<16> a, Pack<16> b) noexcept {
  return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ)};
}
inline PackMask<16> operator>(Pack<16> a, Pack<16> b) noexcept {
  return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ)};
}
inline PackMask<16> operator>=(Pack<16> a, Pack<16> b) noexcept {
  return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ)};
}
inline PackMask<16> operator==(Pack<16> a, Pack<16> b) noexcept {
  return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ)};
}
inline PackMask<16> both(PackMask<16> a, PackMask<16> b) noexcept {
  return {static_cast<__mmask16>(a.bits & b.bits)};
}
inline PackMask<16> either(PackMask<16> a, PackMask<16> b) noexcept {
  return {static_cast<__mmask16>(a.bits | b.bits)};
}
inline PackMask<16> no(PackMask<16> a) noexcept { return {static_cast<__mmask16>(~a.bits)}; }
inline bool any(PackMask<16> m) noexcept { return m.bits != 0; }
inline Pack<16> select(PackMask<16> m, Pack<16> a, Pack<16> b) noexcept {
  return _mm512_mask_blend_ps(m.bits, b.v, a.v);
}
inline Pack<16> two_to(Pack<16> n) noexcept {
  const __m512i exponent = _mm512_add_epi32(_mm512_cvtps_epi32(n.v), _mm512_set1_epi32(127));
  return _mm512_castsi512_ps(_mm512_slli_epi32(exponent, 23));
}
inline void load(const float* from, Pack<16>& to) noexcept { to.v = _mm512_loadu_ps(from); }
inline void store(Pack<16> from, float* to) noexcept { _mm512_storeu_ps(to, from.v); }
#endif

}  // namespace sandrunner::sim
#endif
