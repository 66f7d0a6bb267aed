// SPDX-License-Identifier: BSD-3-Clause
// The batch's inner loop for one width; included by the source of each instruction set.
#pragma once

#include <algorithm>
#include <new>

#include "sim/batch/batch.h"
#include "sim/step/actuator.h"

namespace sandrunner::sim::detail {

template <typename S>
void advance_pack(void* memory, const FootProfile<double>& foot_profile,
                  const StepSettings& settings, const HeightGrid* const* heights,
                  Footprints* const* footprints, int ticks) {
  auto& r = *static_cast<BatchRobot<S>*>(memory);
  const FootProfile<S> foot = convert_profile<S>(foot_profile);
  static thread_local RobotStepper<S> stepper;  // too large to be cleared for each call
  StepReport<S> report;
  Relief<S> relief;
  Prints<S> prints;
  if (heights != nullptr) std::copy_n(heights, relief.grids.size(), relief.grids.begin());
  if (footprints != nullptr) std::copy_n(footprints, prints.of.size(), prints.of.begin());
  const S zero = S(0.0), one = S(1.0);
  r.sums = {};
  BatchSums<S> sums{};
  for (int tick = 0; tick < ticks; ++tick) {
    const Mask<S> arrived = S(double(tick)) >= r.drive.switch_tick;
    std::array<S, kNumJoints> torque;
    S too_fast = zero, past_stop = zero;
    for (int j = 0; j < kNumJoints; ++j) {
      const S q = r.state.rigid.q[j], qd = r.state.rigid.qd[j];
      const S desired = select(arrived, r.drive.target[j], r.drive.target_before[j]);
      torque[j] = r.drive.torque_scale *
                  drive_torque<S>(j, q, qd, {.q = desired, .kp = r.drive.kp, .kd = r.drive.kd},
                                  r.model.torque_limit_nm[j], r.drive.line);
      const S as_haa = r.drive.heat_factor[j % 3] * torque[j];
      sums.torque_squared = fma(as_haa, as_haa, sums.torque_squared);
      sums.power = fma(torque[j], qd, sums.power);
      if (j % 3 != 0) {
        sums.extension_power = fma(max(torque[j], zero), max(qd, zero), sums.extension_power);
      }
      sums.speed_squared = fma(qd, qd, sums.speed_squared);
      const S limit = r.model.speed_limit_radps[j];
      const S fast = max(fma(S(-kSpeedMargin), limit, abs(qd)), zero);
      sums.speed_excess = fma(fast, fast, sums.speed_excess);
      too_fast = max(too_fast, abs(qd) - limit);
      const S past = max(max(r.model.lower_rad[j] - q, q - r.model.upper_rad[j]), zero);
      past_stop = max(past_stop, past);
    }
    sums.ticks_too_fast = sums.ticks_too_fast + select(too_fast > zero, one, zero);
    sums.ticks_past_stop = sums.ticks_past_stop + select(past_stop > zero, one, zero);
    stepper.step(r.model, foot, r.terrain, settings, torque, r.state, report, relief, prints);
    for (int l = 0; l < kNumLegs; ++l) {
      const Vec3<S>& v = report.foot_velocity[l];
      sums.foot_load[l] = sums.foot_load[l] + report.foot_force[l][2];
      sums.slip = sums.slip + select(report.penetration[l] >= zero, fma(v.x, v.x, v.y * v.y), zero);
    }
    sums.base_contact = max(sums.base_contact, report.base_contact);
    sums.thigh_contact = max(sums.thigh_contact, report.thigh_contact);
  }
  r.sums = sums;
  r.report.foot_velocity = report.foot_velocity;
  r.report.penetration = report.penetration;
  r.report.foot_force = report.foot_force;
}

template <typename S>
BatchKernel make_kernel() noexcept {
  constexpr std::size_t kWidth = sizeof(S) / sizeof(float);  // NOLINT(bugprone-sizeof-expression)
  // Every member is an S, so a pack is an array of robots' floats with the lanes innermost.
  static_assert(sizeof(BatchRobot<S>) == kWidth * sizeof(BatchRobot<float>));
  return {static_cast<int>(kWidth), sizeof(BatchRobot<S>), alignof(BatchRobot<S>),
          [](void* memory) { new (memory) BatchRobot<S>(); }, &advance_pack<S>};
}

}  // namespace sandrunner::sim::detail
