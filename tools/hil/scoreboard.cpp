// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/scoreboard.h"

#include <algorithm>
#include <cmath>

namespace sandrunner::hil {
namespace {

constexpr double kSameGain = 0.01;

double distance_m(const Place& from, const Place& to) noexcept {
  return std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
}

}  // namespace

const char* Score::why_no_speed() const noexcept {
  if (mean_speed_mps) return nullptr;
  if (!enabled_at_s) return "the drives were never all on";
  return "the drives never had the policy's gains all together (in torque mode they get none)";
}

Scoreboard::Scoreboard(double cycle_s, double walk_s, double walk_kp_nmprad, Place lay)
    : cycle_s_(cycle_s), walk_s_(walk_s), walk_kp_nmprad_(walk_kp_nmprad), lay_(lay), base_(lay) {}

void Scoreboard::fault_made(const std::string& text, double now_s) {
  score_.faults.emplace_back();
  score_.faults.back().text = text;
  score_.faults.back().made_at_s = now_s;
}

void Scoreboard::note(double now_s, const JointArray<DriveMoment>& drives, Place base,
                      bool base_contact) {
  const auto all = [&](const auto& is_so) { return std::ranges::all_of(drives, is_so); };
  const bool on = all([](const DriveMoment& d) { return d.on; });
  const bool walks =
      walk_kp_nmprad_ > 0.0 && all([&](const DriveMoment& d) {
        return std::fabs(d.kp_nmprad - walk_kp_nmprad_) < kSameGain * walk_kp_nmprad_;
      });
  const bool damped = all([](const DriveMoment& d) { return d.passive || !d.reachable; });
  const bool passive = all([](const DriveMoment& d) { return d.passive; });
  const bool limp = all([](const DriveMoment& d) { return d.limp; });
  base_ = base;
  score_.off_at_end = all([](const DriveMoment& d) { return d.off; });
  if (on && !score_.enabled_at_s) score_.enabled_at_s = now_s;
  if (on && walks) {
    walk_.push_back(base);
    score_.base_touched = score_.base_touched || base_contact;
  }
  for (FaultFigures& figures : score_.faults) {
    const double since_s = now_s - figures.made_at_s;
    if (damped && !figures.damped_after_s) figures.damped_after_s = since_s;
    if (passive && !figures.passive_after_s) figures.passive_after_s = since_s;
    if (figures.limp_after_s) continue;
    for (const DriveMoment& drive : drives) {
      figures.largest_torque_nm = std::max(figures.largest_torque_nm, std::fabs(drive.torque_nm));
    }
    if (limp) figures.limp_after_s = since_s;
  }
}

Score Scoreboard::score() const {
  Score score = score_;
  score.distance_m = distance_m(lay_, base_);
  score.walked_s = static_cast<double>(walk_.size()) * cycle_s_;
  std::size_t cycles = walk_.size();
  if (walk_s_ > 0.0) {
    cycles = std::min(cycles, static_cast<std::size_t>(std::floor(walk_s_ / cycle_s_ + 0.5)));
  }
  if (cycles > 1) {
    const std::size_t half = cycles / 2;
    score.mean_speed_mps = distance_m(walk_[half], walk_[cycles - 1]) /
                           (static_cast<double>(cycles - 1 - half) * cycle_s_);
  }
  return score;
}

}  // namespace sandrunner::hil
