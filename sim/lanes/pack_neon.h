// SPDX-License-Identifier: BSD-3-Clause
// pack.h for 64-bit ARM: a pack is an array of registers of four floats. The same bits as on x86,
// but for two results that no healthy step has: the NaN of an invalid operation has another sign,
// and a result that rounds up to the smallest normal number is flushed to zero.
#pragma once

#include <arm_neon.h>

#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

template <int kLanes>
struct PackMask {
  uint32x4_t v[kLanes / 4];
};

template <int kLanes>
struct alignas(4 * kLanes) Pack {
  using Element = float;
  static constexpr int kWidth = kLanes;
  float32x4_t v[kLanes / 4];
  Pack() = default;
  explicit Pack(float x) noexcept {
    for (float32x4_t& four : v) four = vdupq_n_f32(x);
  }
  explicit Pack(double x) noexcept : Pack(static_cast<float>(x)) {}
};

template <int kLanes>
struct MaskOf<Pack<kLanes>> {
  using type = PackMask<kLanes>;
};

namespace detail {
/// The operation on each register of the operands, packs or masks.
template <template <int> typename Result, auto kOperation, int kLanes, typename... Operands>
inline Result<kLanes> each(const Operands&... operands) noexcept {
  Result<kLanes> result;
  for (int i = 0; i < kLanes / 4; ++i) result.v[i] = kOperation(operands.v[i]...);
  return result;
}
template <auto kOperation, int kLanes, typename... Operands>
inline Pack<kLanes> pack_of(Pack<kLanes> first, Operands... others) noexcept {
  return each<Pack, kOperation, kLanes>(first, others...);
}
template <auto kOperation, int kLanes>
inline PackMask<kLanes> comparison_of(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return each<PackMask, kOperation, kLanes>(a, b);
}
}  // namespace detail

template <int kLanes>
inline Pack<kLanes> operator+(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::pack_of<vaddq_f32>(a, b);
}
template <int kLanes>
inline Pack<kLanes> operator-(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::pack_of<vsubq_f32>(a, b);
}
template <int kLanes>
inline Pack<kLanes> operator*(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::pack_of<vmulq_f32>(a, b);
}
template <int kLanes>
inline Pack<kLanes> operator/(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::pack_of<vdivq_f32>(a, b);
}
template <int kLanes>
inline Pack<kLanes> operator-(Pack<kLanes> a) noexcept {
  return detail::pack_of<vnegq_f32>(a);
}
template <int kLanes>
inline Pack<kLanes> fma(Pack<kLanes> a, Pack<kLanes> b, Pack<kLanes> c) noexcept {
  return detail::pack_of<vfmaq_f32>(c, a, b);
}
template <int kLanes>
inline Pack<kLanes> sqrt(Pack<kLanes> a) noexcept {
  return detail::pack_of<vsqrtq_f32>(a);
}
template <int kLanes>
inline Pack<kLanes> floor(Pack<kLanes> a) noexcept {
  return detail::pack_of<vrndmq_f32>(a);
}
template <int kLanes>
inline Pack<kLanes> abs(Pack<kLanes> a) noexcept {
  return detail::pack_of<vabsq_f32>(a);
}
// As x86 does it: the second operand where neither is smaller (larger). vminq_f32 does not.
template <int kLanes>
inline Pack<kLanes> min(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return select(a < b, a, b);
}
template <int kLanes>
inline Pack<kLanes> max(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return select(a > b, a, b);
}
template <int kLanes>
inline PackMask<kLanes> operator<(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::comparison_of<vcltq_f32>(a, b);
}
template <int kLanes>
inline PackMask<kLanes> operator>(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::comparison_of<vcgtq_f32>(a, b);
}
template <int kLanes>
inline PackMask<kLanes> operator>=(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::comparison_of<vcgeq_f32>(a, b);
}
template <int kLanes>
inline PackMask<kLanes> operator==(Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::comparison_of<vceqq_f32>(a, b);
}
template <int kLanes>
inline PackMask<kLanes> both(PackMask<kLanes> a, PackMask<kLanes> b) noexcept {
  return detail::each<PackMask, vandq_u32, kLanes>(a, b);
}
template <int kLanes>
inline PackMask<kLanes> either(PackMask<kLanes> a, PackMask<kLanes> b) noexcept {
  return detail::each<PackMask, vorrq_u32, kLanes>(a, b);
}
template <int kLanes>
inline PackMask<kLanes> no(PackMask<kLanes> a) noexcept {
  return detail::each<PackMask, vmvnq_u32, kLanes>(a);
}
template <int kLanes>
inline bool any(PackMask<kLanes> m) noexcept {
  uint32x4_t lanes = m.v[0];
  for (int i = 1; i < kLanes / 4; ++i) lanes = vorrq_u32(lanes, m.v[i]);
  return vmaxvq_u32(lanes) != 0;
}
template <int kLanes>
inline Pack<kLanes> select(PackMask<kLanes> m, Pack<kLanes> a, Pack<kLanes> b) noexcept {
  return detail::each<Pack, vbslq_f32, kLanes>(m, a, b);
}
/// 2^n for whole n from -126 to 127.
template <int kLanes>
inline Pack<kLanes> two_to(Pack<kLanes> n) noexcept {
  constexpr auto kTwoTo = [](float32x4_t four) {
    const int32x4_t exponent = vaddq_s32(vcvtnq_s32_f32(four), vdupq_n_s32(127));
    return vreinterpretq_f32_s32(vshlq_n_s32(exponent, 23));
  };
  return detail::pack_of<kTwoTo>(n);
}
template <int kLanes>
inline void load(const float* from, Pack<kLanes>& to) noexcept {
  for (int i = 0; i < kLanes / 4; ++i) to.v[i] = vld1q_f32(from + 4 * i);
}
template <int kLanes>
inline void store(Pack<kLanes> from, float* to) noexcept {
  for (int i = 0; i < kLanes / 4; ++i) vst1q_f32(to + 4 * i, from.v[i]);
}

}  // namespace sandrunner::sim
