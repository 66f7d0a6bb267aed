// SPDX-License-Identifier: BSD-3-Clause
// The fused multiply-add a b + c, rounded once: the same bits on every processor. WebAssembly has
// none. There it is the relaxed one, which is the processor's where that has one, as who runs the
// module must check, or else the exact emulation.
#pragma once

#ifdef __wasm__
#include <wasm_simd128.h>

#include "rt/core/exact_fma.h"
#else
#include <cmath>
#endif

namespace sandrunner {

#ifndef __wasm__
inline double fma(double a, double b, double c) noexcept { return std::fma(a, b, c); }
inline float fma(float a, float b, float c) noexcept { return std::fma(a, b, c); }
#elif defined(__wasm_relaxed_simd__)
inline double fma(double a, double b, double c) noexcept {
  return __builtin_wasm_relaxed_madd_f64x2(wasm_f64x2_splat(a), wasm_f64x2_splat(b),
                                           wasm_f64x2_splat(c))[0];
}
/// Of four floats.
inline v128_t fma(v128_t a, v128_t b, v128_t c) noexcept {
  return __builtin_wasm_relaxed_madd_f32x4(a, b, c);
}
inline float fma(float a, float b, float c) noexcept {
  return wasm_f32x4_extract_lane(fma(wasm_f32x4_splat(a), wasm_f32x4_splat(b), wasm_f32x4_splat(c)),
                                 0);
}
#else
inline double fma(double a, double b, double c) noexcept { return exact_fma(a, b, c); }
inline float fma(float a, float b, float c) noexcept { return exact_fma(a, b, c); }
/// Of four floats.
inline v128_t fma(v128_t a, v128_t b, v128_t c) noexcept {
  float x[4], y[4], z[4];
  wasm_v128_store(x, a), wasm_v128_store(y, b), wasm_v128_store(z, c);
  for (int i = 0; i < 4; ++i) z[i] = exact_fma(x[i], y[i], z[i]);
  return wasm_v128_load(z);
}
#endif

}  // namespace sandrunner
