// SPDX-License-Identifier: BSD-3-Clause
#include "tools/python/recorder.h"

#include <cmath>
#include <limits>

#include "rt/base/errors.h"
#include "rt/base/output_files.h"
#include "rt/run/robot_scene.h"
#include "rt/telemetry/view/view_page.h"
#include "sim/step/ground_truth.h"
#include "tools/python/checks.h"
#include "tools/python/one_at_a_time.h"

namespace sandrunner::python {
namespace {

Vector3 vector_of(const sim::Vec3<float>& v) { return {v.x, v.y, v.z}; }

RunScene scene_of(Environments& environments, int env) {
  const OneAtATime lock(environments.busy());
  RunScene scene = robot_scene(environments.robot(), environments.task().terrain(env));
  scene.terrain = "training ground";
  return scene;
}

}  // namespace

Recorder::Recorder(Environments& environments, int env)
    : environments_(environments),
      env_(checked("env", env, 0, environments.envs() - 1)),
      record_{.scene = scene_of(environments, env_)},
      rows_(record_.scene) {}

TickRecord Recorder::tick_now() const {
  const sim::Batch& batch = environments_.task().batch();
  const sim::RobotState<float> state = batch.state(env_);
  const sim::BatchReport<float> report = batch.report(env_);
  const sim::RigidState<float>& x = state.rigid;
  const std::array<float, 3>& command = environments_.task().command(env_);
  TickRecord tick;
  tick.has_truth = tick.counts = 1;
  tick.input.sensors.tick = tick_;
  tick.output.mode = Mode::kWalk;
  tick.output.policy_input.command = {command[0], command[1], command[2]};
  tick.input.command.velocity = tick.output.policy_input.command;
  RobotTruth& truth = tick.truth;
  truth.position_m = vector_of(x.position);
  truth.orientation_wxyz = {x.orientation.w, x.orientation.x, x.orientation.y, x.orientation.z};
  truth.velocity_mps = vector_of(x.velocity);
  truth.angular_velocity_radps = vector_of(x.angular_velocity);
  for (int j = 0; j < kNumJoints; ++j) {
    truth.joint_position_rad[j] = x.q[j];
    truth.joint_velocity_radps[j] = tick.before.joint_velocity_radps[j] = x.qd[j];
  }
  truth.joint_torque_nm.fill(std::numeric_limits<double>::quiet_NaN());  // a batch keeps sums alone
  truth.state =
      sim::ground_truth(environments_.robot().model, state, environments_.task().terrain(env_));
  tick.before.state = truth.state;
  Kinematics kinematics(environments_.robot().description);
  kinematics.place({truth.position_m, truth.orientation_wxyz}, truth.joint_position_rad);
  for (std::size_t l = 0; l < kNumLegs; ++l) {
    truth.foot_centre_m[l] = kinematics.legs()[l].foot;
    truth.foot_penetration_m[l] = report.penetration[l];
    for (std::size_t i = 0; i < 3; ++i) truth.foot_force_n[l][i] = report.foot_force[l][i];
  }
  tick.input.sensors.imu.orientation_wxyz = truth.orientation_wxyz;
  tick.input.sensors.imu.angular_velocity_radps = truth.angular_velocity_radps;
  tick.input.sensors.joints.position_rad = truth.joint_position_rad;
  tick.input.sensors.joints.velocity_radps = truth.joint_velocity_radps;
  return tick;
}

// A foot that has left the ground leaves its footprint.
void Recorder::add_row(const RunRow& row) {
  if (!record_.rows.empty()) {
    const RunRow& before = record_.rows.back();
    for (std::size_t l = 0; l < kNumLegs; ++l) {
      const auto& [x_m, y_m, depth_m] = before.stance_m[l];
      if (depth_m > 0.0f && row.stance_m[l][2] == 0.0f) {
        record_.add(Footprint{.t_s = row.t_s,
                              .x_m = x_m,
                              .y_m = y_m,
                              .depth_m = depth_m,
                              .leg = static_cast<std::uint32_t>(l)});
      }
    }
  }
  record_.add(row);
}

bool Recorder::add() {
  const OneAtATime lock(environments_.busy());
  over_ = over_ || environments_.ended()[static_cast<std::size_t>(env_)] != 0;
  if (over_) return false;
  if (const auto row = rows_.add(tick_now())) add_row(*row);
  tick_ += kTicksPerPolicyStep;
  return true;
}

void Recorder::write(const std::string& path, const std::string& title) {
  if (const auto row = rows_.take_last()) add_row(*row);
  if (record_.rows.empty()) {
    throw InputError("Recorder: found no step, expected some before the page is written");
  }
  RunRecord record = record_;
  record.scene.policy = title;
  write_file(path, run_page(record));
}

}  // namespace sandrunner::python
