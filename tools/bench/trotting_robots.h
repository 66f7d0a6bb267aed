// SPDX-License-Identifier: BSD-3-Clause
// The load: robots that trot by a fixed script on dry sand, every effect of the ground, the drives
// and the delay on. Each has its own masses, moment in the stride and delay, so that the lanes of a
// pack differ as they do in training.
#pragma once

#include <vector>

#include "sim/batch/batch.h"
#include "sim/ground/terrain_description.h"
#include "sim/robot/robot_model.h"
#include "sim/step/actuator.h"

namespace sandrunner::bench {

inline constexpr double kTrotKp = 100.0;  ///< N m/rad
inline constexpr double kTrotKd = 2.0;    ///< N m s/rad
inline constexpr double kTrotHz = 2.5;
/// A robot whose base is lower has fallen, m.
inline constexpr double kFallenHeight_m = 0.25;

/// Joint targets of the trot at a time, rad: diagonal legs are lifted alternately. `phase`: of the
/// stride, 0..1.
JointArray<double> trot_targets(const JointArray<double>& nominal_rad, double time_s, double phase);

/// Robots in a batch of some width.
class TrottingBatch {
 public:
  TrottingBatch(const sim::Robot& robot, int robots, sim::BatchWidth width);

  /// Policy periods (40 ticks) of the packs [first, last): the drives of their robots are written,
  /// the packs advance.
  void advance(int first_pack, int last_pack, int periods);

  int size() const { return batch_.size(); }
  int packs() const { return batch_.packs(); }
  int fallen() const;
  /// Feet on the ground, mean over the robots.
  double mean_contacts() const;

 private:
  JointArray<double> nominal_rad_;
  sim::Batch batch_;
  std::vector<sim::BatchDrive<float>> drives_;
  std::vector<double> phases_;
  std::vector<int> pack_periods_;  // done so far
};

/// One robot in double, with the drives and delay of the batch.
class TrottingRobot {
 public:
  explicit TrottingRobot(const sim::Robot& robot);
  void advance(int periods);
  bool fallen() const { return !(state_.rigid.position.z > kFallenHeight_m); }

 private:
  sim::Robot robot_;
  sim::FootProfile<double> foot_;
  sim::Terrain<double> terrain_;
  sim::RobotStepper<double> stepper_;
  sim::RobotState<double> state_;
  sim::StepReport<double> report_;
  JointArray<double> target_before_{}, target_{};
  int periods_ = 0;
};

}  // namespace sandrunner::bench
