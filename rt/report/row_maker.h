// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "estimator/kinematics.h"
#include "estimator/odometry.h"
#include "rt/core/slower_rate.h"
#include "rt/loop/tick_record.h"
#include "rt/report/joint_power.h"
#include "rt/report/run_record.h"
#include "rt/report/stances.h"

namespace sandrunner {

/// Ticks into rows and footprints. Ordinary threads; the order of the ticks matters, gaps do not.
class RowMaker {
 public:
  /// `scene` must outlive this object.
  explicit RowMaker(const RunScene& scene)
      : scene_(scene),
        heat_factor_(heat_factors<double>(scene.motor_constant)),
        odometry_(scene.robot),
        kinematics_(scene.robot) {}

  /// The row that this tick completes, if any. A row waits for the network's answer to its own
  /// sensors, so it comes a tick or a few later; at the latest when the next one begins.
  std::optional<RunRow> add(const TickRecord& tick);
  /// The row that still waits.
  std::optional<RunRow> take_last();

  /// Footprints since the last call.
  std::vector<Footprint> take_footprints();

 private:
  /// Sums over the ticks since the row before.
  struct Sums {
    int ticks = 0, counted = 0;
    JointPower power;
    std::array<double, 3> motion{};
    JointArray<double> peak_torque_nm{};
    TickTiming worst;
    std::int64_t worst_tick_ns = 0;
  };
  /// What the cost of transport is made of: means of one period.
  struct Effort {
    JointPower power;
    double vx_mps = 0.0, vy_mps = 0.0;
  };

  void follow(const TickRecord& tick);
  RunRow make_row(const TickRecord& tick);
  void set_truth(const TickRecord& tick, RunRow& row) const;
  float cost_of_transport(const Effort& newest);

  const RunScene& scene_;
  const LegJoints<double> heat_factor_;
  SlowerRate rate_{kPolicyHz};
  Odometry odometry_;
  Kinematics kinematics_;
  StanceWatch stances_;
  std::vector<Footprint> footprints_;
  std::optional<RunRow> waiting_;
  std::uint64_t waiting_tick_ = 0, policy_sequence_ = 0;
  std::uint32_t skipped_ = 0;
  Sums sums_;
  std::deque<Effort> last_second_;
};

}  // namespace sandrunner
