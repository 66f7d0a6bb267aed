// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/batch/batch.h"
#include "tools/train/learner/learner.h"
#include "tools/train/task/normalise.h"
#include "tools/train/task/reward.h"
#include "tools/train/task/task_config.h"

namespace sandrunner::train {

/// What opens as the policy gets better. Speed: commands; ground: how soft and uneven, 0 to 1.
struct Curriculum {
  double speed_mps = 0.0;
  double ground = 0.0;
};

/// Means of a window, for the progress line, the learning curve and the curricula. [0] rigid, [1]
/// soil.
struct WindowStats {
  double reward = 0.0;
  std::array<double, 2> kernel{};  ///< velocity kernel
  std::array<double, 2> falls{};   ///< per 4 s and robot
  std::array<double, 2>
      speed_ratio{};        ///< speed along the command over the command, where it is above 0.3 m/s
  double top_kernel = 0.0;  ///< on soil, commands above 3/4 of the curriculum's speed
  double top_count = 0.0;
  double body_height_m = 0.0;  ///< on rigid ground
  double torque_squared = 0.0, power_w = 0.0;
  double stride_hz = 0.0;  ///< lift-offs of a foot per second
  /// How feet go together while the robot is told to go, side by side ones and diagonal ones: 1
  /// together, 0 as chance has it, below 0 in turn. Share of the steps in which both are loaded or
  /// both not, a, as (a - b)/(1 - b), b that of independent feet.
  double abreast = 0.0, diagonal = 0.0;
};

/// Trotting on randomised ground: the environments of the training. Robots live in a Batch; a block
/// of environments is stepped by one thread. Same seed and actions: same bits, for any number of
/// threads and width of the batch.
class Task {
 public:
  Task(const TrainConfig& config, const sim::Robot& robot, std::uint64_t seed);

  static constexpr int privileged_size() { return kPrivileged; }
  const InputScales& scales() const { return scales_; }
  /// Left for right: the robot and its task are the same in the mirror.
  static learner::Symmetry symmetry();

  /// Writes observation(t), privileged(t) and estimate_target(t) of a block.
  void observe(int block, int t, learner::Rollout& rollout);
  /// Takes action(t) of a block, moves its robots 10 ms on, writes reward(t), end(t), resets whom
  /// it must, and writes what observe(t + 1) would.
  void step(int block, int t, learner::Learner& learner, int worker);

  /// Means of the window just done; clears them and moves the curricula. `transitions`: total, for
  /// the ramp of the costs.
  WindowStats end_window(double transitions);
  const Curriculum& curriculum() const { return curriculum_; }
  /// Share, 0 to 1, of what comes late in the training: rises while the costs go to their end.
  double late() const { return cost_ramp_.late; }

  void save(learner::Checkpoint& checkpoint) const;
  void load(const learner::Checkpoint& checkpoint);

 private:
  static constexpr int kPrivileged =
      kObservationSize + kEstimateSize + 4 * kNumLegs + kNumJoints + 8;

  static constexpr int kGroundFeatures = 6;

  // One environment beside its robot in the batch. Trivially copyable: a checkpoint.
  struct Env {
    std::uint64_t draws = 0;
    std::array<float, 3> command{};
    std::int32_t step = 0, command_steps_left = 0;
    JointArray<float> action_1{}, action_2{};
    JointArray<float> joint_offset{};
    std::array<float, kNumLegs> air_s{}, stance_s{};
    std::array<std::int32_t, kNumLegs> unloaded_steps{};
    std::array<float, 3> drift{};  // vx, vy, yaw rate, low-passed
    float noise_level = 1.0f;
    // For the critic: of each patch of ground, and of the robot.
    std::array<std::array<float, kGroundFeatures>, sim::kMaxRegions> ground_features{};
    std::array<float, 2> robot_features{};
    sim::BatchDrive<float> drive;
    sim::Terrain<float> terrain;
  };
  struct Sums {  // of one block and window
    double steps = 0, reward = 0, torque_squared = 0, power = 0, height = 0, height_steps = 0,
           lift_offs = 0, abreast = 0, diagonal = 0, loaded = 0, gait_steps = 0;
    std::array<double, 2> kernel{}, kind_steps{}, falls{}, ratio{}, ratio_steps{};
    double top_kernel = 0, top_steps = 0;
  };

  double uniform(int env, Env& e) const;  // [0, 1)
  double uniform(int env, Env& e, double low, double high) const;
  double normal(int env, Env& e) const;
  bool is_rigid(int env) const { return env % block_envs_ < config_.ground.rigid_envs; }
  bool is_patchy(int env) const {
    return env % block_envs_ >= block_envs_ - config_.ground.patchy_envs;
  }
  void new_command(int env, Env& e) const;
  sim::Ground<double> draw_ground(int env, Env& e, bool rigid,
                                  std::array<float, kGroundFeatures>& features) const;
  void new_ground(int env, Env& e, float x_m);
  void new_robot(int env, Env& e);
  void hard_reset(int env, Env& e);
  void push(int env, Env& e, sim::RobotState<float>& state) const;
  std::array<float, kEstimateSize> truth(const Env& e, const sim::RobotState<float>& state) const;
  void observe_env(int env, int t, learner::Rollout& rollout);
  void privileged(int env, const Env& e, const sim::RobotState<float>& state,
                  const sim::BatchReport<float>& report, float* out) const;

  TrainConfig config_;
  std::uint64_t seed_;
  int block_envs_;
  sim::Robot robot_;
  InputScales scales_;
  sim::FootProfile<double> foot_;
  sim::Batch batch_;
  std::vector<Env> envs_;
  std::vector<Sums> sums_;  // one a block
  Curriculum curriculum_;
  CostRamp cost_ramp_;
  double tilt_end_cos_;
};

}  // namespace sandrunner::train
