// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_record.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sandrunner {
namespace {

// `from` stands for `weight` times as many periods as `to`.
void hand_on(const RunRow& from, std::size_t weight, RunRow& to) {
  for (std::size_t j = 0; j < kNumJoints; ++j) {
    if (std::abs(from.peak_torque_nm[j]) > std::abs(to.peak_torque_nm[j])) {
      to.peak_torque_nm[j] = from.peak_torque_nm[j];
    }
  }
  const auto n = static_cast<float>(weight);
  const auto mean = [n](float a, float& b) { b = (n * a + b) / (n + 1.0f); };
  for (std::size_t k = 0; k < 3; ++k) mean(from.mean_motion[k], to.mean_motion[k]);
  mean(from.power_w, to.power_w);
  mean(from.torque_squared_nm2, to.torque_squared_nm2);
  to.late_us = std::max(from.late_us, to.late_us);
  to.control_us = std::max(from.control_us, to.control_us);
  to.tick_us = std::max(from.tick_us, to.tick_us);
}

}  // namespace

void RunRecord::add(const RunRow& row) {
  RunRow next = row;
  if (periods_left_out > 0) hand_on(left_out, periods_left_out, next);
  if (++periods_left_out < periods_per_row) {
    left_out = next;
    return;
  }
  periods_left_out = 0;
  rows.push_back(next);
  if (rows.size() >= kMostRows) thin();
}

void RunRecord::add(const Footprint& footprint) {
  if (footprints.size() == kMostFootprints) footprints.pop_front();
  footprints.push_back(footprint);
}

void RunRecord::thin() {
  const std::size_t pairs = rows.size() / 2;
  for (std::size_t i = 0; i < pairs; ++i) {
    hand_on(rows[2 * i], 1, rows[2 * i + 1]);
    rows[i] = rows[2 * i + 1];
  }
  rows.resize(pairs);
  periods_per_row *= 2;
}

}  // namespace sandrunner
