// SPDX-License-Identifier: BSD-3-Clause
// Eight floats in registers: one of AVX, two of NEON or of WebAssembly. Memory is aligned to 32
// bytes.
#pragma once

#ifdef __aarch64__
#include <arm_neon.h>
#elif defined(__wasm__)
#include <wasm_simd128.h>

#include "rt/core/fma.h"
#else
#include <immintrin.h>
#endif

namespace sandrunner {

#ifdef __aarch64__
struct EightFloats {
  float32x4_t low, high;
};
inline EightFloats load_eight(const float* from) noexcept {
  return {vld1q_f32(from), vld1q_f32(from + 4)};
}
inline EightFloats eight_times(float x) noexcept { return {vdupq_n_f32(x), vdupq_n_f32(x)}; }
inline EightFloats add(EightFloats a, EightFloats b) noexcept {
  return {vaddq_f32(a.low, b.low), vaddq_f32(a.high, b.high)};
}
/// a b + c, fused.
inline EightFloats multiply_add(EightFloats a, EightFloats b, EightFloats c) noexcept {
  return {vfmaq_f32(c.low, a.low, b.low), vfmaq_f32(c.high, a.high, b.high)};
}
/// Their bits.
inline EightFloats either(EightFloats a, EightFloats b) noexcept {
  const auto either_four = [](float32x4_t x, float32x4_t y) {
    return vreinterpretq_f32_u32(vorrq_u32(vreinterpretq_u32_f32(x), vreinterpretq_u32_f32(y)));
  };
  return {either_four(a.low, b.low), either_four(a.high, b.high)};
}
inline void store_eight(float* to, EightFloats a) noexcept {
  vst1q_f32(to, a.low);
  vst1q_f32(to + 4, a.high);
}
#elif defined(__wasm__)
struct EightFloats {
  v128_t low, high;
};
inline EightFloats load_eight(const float* from) noexcept {
  return {wasm_v128_load(from), wasm_v128_load(from + 4)};
}
inline EightFloats eight_times(float x) noexcept {
  return {wasm_f32x4_splat(x), wasm_f32x4_splat(x)};
}
inline EightFloats add(EightFloats a, EightFloats b) noexcept {
  return {wasm_f32x4_add(a.low, b.low), wasm_f32x4_add(a.high, b.high)};
}
/// a b + c, fused.
inline EightFloats multiply_add(EightFloats a, EightFloats b, EightFloats c) noexcept {
  return {fma(a.low, b.low, c.low), fma(a.high, b.high, c.high)};
}
/// Their bits.
inline EightFloats either(EightFloats a, EightFloats b) noexcept {
  return {wasm_v128_or(a.low, b.low), wasm_v128_or(a.high, b.high)};
}
inline void store_eight(float* to, EightFloats a) noexcept {
  wasm_v128_store(to, a.low);
  wasm_v128_store(to + 4, a.high);
}
#else
using EightFloats = __m256;
inline EightFloats load_eight(const float* from) noexcept { return _mm256_load_ps(from); }
inline EightFloats eight_times(float x) noexcept { return _mm256_set1_ps(x); }
inline EightFloats add(EightFloats a, EightFloats b) noexcept { return _mm256_add_ps(a, b); }
/// a b + c, fused.
inline EightFloats multiply_add(EightFloats a, EightFloats b, EightFloats c) noexcept {
  return _mm256_fmadd_ps(a, b, c);
}
/// Their bits.
inline EightFloats either(EightFloats a, EightFloats b) noexcept { return _mm256_or_ps(a, b); }
inline void store_eight(float* to, EightFloats a) noexcept { _mm256_store_ps(to, a); }
#endif

}  // namespace sandrunner
