// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/trotting_robots.h"

#include <algorithm>
#include <cmath>

#include "sim/lanes/random.h"

namespace sandrunner::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr int kDelay_ticks = 20;
// The script of the trot, found by a search for one that keeps robots up on dry sand without
// feedback: the legs stand stretched so that the drives' give does not lower the base, swing for
// less than half of the stride, and lift higher than the sinkage. It travels backwards.
constexpr double kSwingShare = 0.36;
constexpr double kLift_rad = 0.65;
constexpr double kStretch_rad = 0.2;
constexpr double kSweep_rad = 0.18;
constexpr double kLean_rad = 0.1;

}  // namespace

JointArray<double> trot_targets(const JointArray<double>& nominal_rad, double time_s,
                                double phase) {
  JointArray<double> target = nominal_rad;
  for (int l = 0; l < kNumLegs; ++l) {
    const bool first_pair = l == 0 || l == 3;  // LF and RH
    const double stride = kTrotHz * time_s + phase + (first_pair ? 0.0 : 0.5);
    const double moment = stride - std::floor(stride);
    double bend = -kStretch_rad, sweep;
    if (moment < kSwingShare) {
      double sine, cosine;
      sim::sincos(3.141592653589793 * moment / kSwingShare, sine, cosine);
      bend += kLift_rad * sine * sine;
      sweep = -cosine;
    } else {
      sweep = 1.0 - 2.0 * (moment - kSwingShare) / (1.0 - kSwingShare);
    }
    // Knee twice as far back as the thigh forward: the foot rises under the hip.
    target[3 * l + 1] += bend + kSweep_rad * sweep + kLean_rad;
    target[3 * l + 2] -= 2.0 * bend;
  }
  return target;
}

TrottingBatch::TrottingBatch(const sim::Robot& robot, int robots, sim::BatchWidth width)
    : nominal_rad_(robot.nominal_rad),
      batch_(robots, sim::make_foot_profile(sim::terrain_preset("dry-sand"), robot.model), {},
             width),
      drives_(static_cast<std::size_t>(robots)),
      phases_(static_cast<std::size_t>(robots)),
      pack_periods_(static_cast<std::size_t>(batch_.packs())) {
  const sim::TerrainDescription sand = sim::terrain_preset("dry-sand");
  const auto terrain = sim::convert_terrain<float>(
      sim::make_terrain(sand, sim::make_foot_profile(sand, robot.model), robot.model));
  for (int i = 0; i < robots; ++i) {
    const auto draw = [&](std::uint64_t counter) {
      return sim::random_uniform(kSeed, static_cast<std::uint64_t>(i), counter);
    };
    const auto at = static_cast<std::size_t>(i);
    phases_[at] = draw(0);
    sim::RobotModel<double> model = robot.model;
    model.base.mass *= 0.9 + 0.2 * draw(1);
    batch_.set_model(i, sim::convert_model<float>(model));
    batch_.set_terrain(i, terrain);
    sim::RobotState<float> state;
    state.rigid.position.z = static_cast<float>(robot.nominal_height_m);
    for (int j = 0; j < kNumJoints; ++j)
      state.rigid.q[j] = static_cast<float>(robot.nominal_rad[j]);
    batch_.set_state(i, state);
    sim::BatchDrive<float>& drive = drives_[at];
    drive.target_before = drive.target = state.rigid.q;
    drive.switch_tick = std::floor(static_cast<float>(2 * kDelay_ticks * draw(2)));
    drive.kp = static_cast<float>(kTrotKp);
    drive.kd = static_cast<float>(kTrotKd);
    drive.line = sim::drive_line<float>(robot.torque_speed_line);
  }
}

void TrottingBatch::advance(int first_pack, int last_pack, int periods) {
  for (int p = first_pack; p < last_pack; ++p) {
    int& done = pack_periods_[static_cast<std::size_t>(p)];
    const int first = p * batch_.width(), last = std::min(first + batch_.width(), batch_.size());
    for (int k = 0; k < periods; ++k, ++done) {
      for (int i = first; i < last; ++i) {
        const auto at = static_cast<std::size_t>(i);
        sim::BatchDrive<float>& drive = drives_[at];
        drive.target_before = drive.target;
        const auto target =
            trot_targets(nominal_rad_, static_cast<double>(done) / kPolicyHz, phases_[at]);
        for (int j = 0; j < kNumJoints; ++j) drive.target[j] = static_cast<float>(target[j]);
        batch_.set_drive(i, drive);
      }
      batch_.advance(p, kTicksPerPolicyStep);
    }
  }
}

int TrottingBatch::fallen() const {
  int count = 0;
  for (int i = 0; i < batch_.size(); ++i) {
    if (!(static_cast<double>(batch_.state(i).rigid.position.z) > kFallenHeight_m)) ++count;
  }
  return count;
}

double TrottingBatch::mean_contacts() const {
  double sum = 0.0;
  for (int i = 0; i < batch_.size(); ++i) {
    for (const auto& foot : batch_.state(i).feet) sum += static_cast<double>(foot.active);
  }
  return sum / batch_.size();
}

TrottingRobot::TrottingRobot(const sim::Robot& robot) : robot_(robot) {
  const sim::TerrainDescription sand = sim::terrain_preset("dry-sand");
  foot_ = sim::make_foot_profile(sand, robot.model);
  terrain_ = sim::make_terrain(sand, foot_, robot.model);
  state_.rigid.position.z = robot.nominal_height_m;
  state_.rigid.q = target_before_ = target_ = robot.nominal_rad;
}

void TrottingRobot::advance(int periods) {
  const auto line = sim::drive_line<double>(robot_.torque_speed_line);
  for (int k = 0; k < periods; ++k, ++periods_) {
    target_before_ = target_;
    target_ = trot_targets(robot_.nominal_rad, static_cast<double>(periods_) / kPolicyHz, 0.0);
    for (int tick = 0; tick < kTicksPerPolicyStep; ++tick) {
      const JointArray<double>& target = tick < kDelay_ticks ? target_before_ : target_;
      JointArray<double> torque_nm;
      for (int j = 0; j < kNumJoints; ++j) {
        torque_nm[j] = sim::drive_torque<double>(j, state_.rigid.q[j], state_.rigid.qd[j],
                                                 {.q = target[j], .kp = kTrotKp, .kd = kTrotKd},
                                                 robot_.model.torque_limit_nm[j], line);
      }
      stepper_.step(robot_.model, foot_, terrain_, {}, torque_nm, state_, report_);
    }
  }
}

}  // namespace sandrunner::bench
