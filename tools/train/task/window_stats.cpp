// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/window_stats.h"

#include <algorithm>
#include <cmath>

namespace sandrunner::train {

void WindowSums::add_step(const StepOutcome& s, const Reward& reward, int kind, int decisive,
                          double top_speed_mps, const reward::Velocity& velocity) {
  const double kernel = velocity.kernel(s);
  steps_ += 1.0;
  reward_ += reward.value;
  for (std::size_t i = 0; i < kRewardTerms; ++i) terms_[i] += reward.terms[i];
  torque_squared_ += s.torque_squared;
  power_ += s.power;
  lift_offs_ += s.lift_offs;
  kernel_[kind] += kernel;
  kind_steps_[kind] += 1.0;
  const double commanded = std::hypot(s.command[0], s.command[1]);
  if (commanded > 0.3) {
    ratio_[kind] += (s.vx * s.command[0] + s.vy * s.command[1]) / (commanded * commanded);
    ratio_steps_[kind] += 1.0;
    abreast_ += 0.5 * (s.contact[0] == s.contact[1]) + 0.5 * (s.contact[2] == s.contact[3]);
    diagonal_ += 0.5 * (s.contact[0] == s.contact[3]) + 0.5 * (s.contact[1] == s.contact[2]);
    for (const bool loaded : s.contact) loaded_ += loaded / double(kNumLegs);
    gait_steps_ += 1.0;
  }
  if (kind == 0) {
    height_ += s.body_height;
    height_steps_ += 1.0;
  }
  if (kind == decisive && s.command[0] > 0.75 * top_speed_mps) {
    top_kernel_ += kernel;
    top_steps_ += 1.0;
  }
}

WindowStats WindowSums::means() const {
  const auto mean = [](double sum, double n) { return n > 0.0 ? sum / n : 0.0; };
  WindowStats w;
  w.reward = mean(reward_, steps_);
  for (std::size_t i = 0; i < kRewardTerms; ++i) w.terms[i] = mean(terms_[i], steps_);
  for (int k = 0; k < 2; ++k) {
    w.kernel[k] = mean(kernel_[k], kind_steps_[k]);
    w.falls[k] = mean(falls_[k], kind_steps_[k]) * 4.0 * kPolicyHz;
    w.speed_ratio[k] = mean(ratio_[k], ratio_steps_[k]);
  }
  w.top_kernel = mean(top_kernel_, top_steps_);
  w.top_steps = top_steps_;
  w.body_height_m = mean(height_, height_steps_);
  w.torque_squared = mean(torque_squared_, steps_);
  w.power_w = mean(power_, steps_);
  const double duty = mean(loaded_, gait_steps_);
  const double independent = duty * duty + (1.0 - duty) * (1.0 - duty);
  const auto together = [&](double sum) {
    return (mean(sum, gait_steps_) - independent) / std::max(1.0 - independent, 1e-3);
  };
  w.abreast = together(abreast_);
  w.diagonal = together(diagonal_);
  w.stride_hz = mean(lift_offs_, steps_) / kNumLegs * kPolicyHz;
  return w;
}

}  // namespace sandrunner::train
