// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/batch/batch.h"
#include "sim/batch/disturbances.h"
#include "sim/batch/sensors.h"
#include "tools/train/data/checkpoint.h"
#include "tools/train/data/rollout.h"
#include "tools/train/data/symmetry.h"
#include "tools/train/task/normalise.h"
#include "tools/train/task/task_config.h"
#include "tools/train/task/window_stats.h"

namespace sandrunner::train {

/// Steps of the simulation a second: half of those of a run. A policy does much the same at both
/// rates (../NOTES.md), and a training takes a fifth less time.
inline constexpr int kSimulationHz = 2000;
inline constexpr int kStepsPerAction = kSimulationHz / kPolicyHz;

/// What grows as the policy gets better. Speed: top speed of the commands; ground: how soft and
/// uneven it may be, 0 to 1.
struct Curriculum {
  double speed_mps = 0.0;
  double ground = 0.0;
};

/// What the robots are commanded now: speeds either way but for forward and backward. Most are
/// commanded from one moment to the next, whatever was commanded before (`ramp_share`).
struct CommandRange {
  double forward_mps = 0, backward_mps = 0, lateral_mps = 0, yaw_radps = 0;
};

/// What an oracle and the critic see of a ground.
using TerrainFeatures = std::array<float, kTerrainSize>;

/// Those of a ground, scaled to about +-1; the critic sees the first six. `factor`: added mass and
/// drag of a soil over the usual ones, or the damping ratio of a spring. Hard ground: 1, 2, 2,
/// friction, factor, roughness and zeros. Soil: 0, both stress gradients (logarithms), friction,
/// factor, how much a firmer layer is felt, recruitment, cone angle, stiffness and damping of a
/// stroke. Spring: 0, stiffness
/// (logarithm), factor, friction and zeros.
TerrainFeatures terrain_features(const sim::GroundParameters& ground, double factor,
                                 double roughness_m = 0.0);

/// A soil's first feature is the logarithm of its stress gradient over this one.
inline constexpr double kUsualSigmaFlat_npm3 = 3e6;

/// How many environments there are, and how many of them make a block, a multiple of 16; how many
/// of them a core steps at once.
struct TaskShape {
  int envs = 0, block_envs = 0;
  sim::BatchWidth width = sim::best_batch_width();
};

/// What a step tells of each environment besides the rollout, for a learner that is not ours.
struct StepDetails {
  explicit StepDetails(int envs)
      : terms(static_cast<std::size_t>(envs)), final_observation(static_cast<std::size_t>(envs)) {}

  std::vector<std::array<float, kRewardTerms>> terms;  ///< Reward::terms; 0 of a diverged robot
  /// Where the step ended an episode: observation of the state in which it was cut, 0 of a diverged
  /// robot. Elsewhere as it was.
  std::vector<std::array<float, kObservationSize>> final_observation;
};

/// An episode whose command and ground are given instead of drawn: the robot starts near its
/// nominal pose, stands, and then gets the command, which rises as a robot's does.
struct Trial {
  const sim::Terrain<float>* terrain = nullptr;  ///< one patch, level
  std::array<float, 3> command{};                ///< vx, vy (m/s), yaw rate (rad/s)
  double stand_s = 0.0;                          ///< before the command rises
  double latency_s = 0.0;                        ///< of the action
  TerrainFeatures features{};                    ///< of the ground
  bool nominal_start = false;  ///< exactly in the nominal pose, at rest; else disturbed
};

/// Trotting on randomised ground: the environments of the training. Robots live in a Batch; a block
/// of environments is stepped by one thread. Same seed and actions: same bits, for any number of
/// threads and width of the batch.
class Task {
 public:
  Task(const TaskConfig& config, const sim::Robot& robot, const TaskShape& shape,
       std::uint64_t seed);

  /// Starts all episodes anew with the draws of this seed. The curricula stay as they are.
  void restart(std::uint64_t seed);

  static constexpr int privileged_size() { return kPrivileged; }
  const InputScales& scales() const { return scales_; }
  /// Left and right exchanged: a robot that check_robot accepts, and its task, are the same in the
  /// mirror.
  static learner::Symmetry symmetry(const sim::Robot& robot);

  /// Writes observation(t), privileged(t), estimate_target(t) and, if the rollout has rows for it,
  /// insight(t) of a block.
  void observe(int block, int t, learner::Rollout& rollout);
  /// Takes action(t) of a block and advances its robots by 10 ms. Writes reward(t), end(t) and, at
  /// a timeout, final_privileged(t); resets robots whose episode is over; writes reset(t + 1) and
  /// what observe(t + 1) would.
  void step(int block, int t, learner::Rollout& rollout);

  /// Starts this trial in an environment, with the same draws each time. Should the robot fall or
  /// the episode end, others follow, with commands and grounds that are drawn.
  void begin_trial(int env, const Trial& trial);
  /// vx, vy (m/s), yaw rate (rad/s) that a robot has been commanded for the next step.
  const std::array<float, 3>& command(int env) const {
    return envs_[static_cast<std::size_t>(env)].command;
  }
  const sim::Batch& batch() const { return batch_; }
  const sim::Terrain<float>& terrain(int env) const {
    return envs_[static_cast<std::size_t>(env)].terrain;
  }
  /// From the next step on, steps fill `details`, which is as large as the task; null: none. The
  /// bits of the rollout do not depend on it.
  void watch(StepDetails* details) { details_ = details; }

  /// Before end_window: gets the sums of the other ranks' blocks.
  void gather_window(const learner::Ranks& ranks) {
    ranks.gather(std::span(sums_), static_cast<int>(sums_.size()));
  }
  /// Means over the window just done; clears its sums and advances the curricula and the
  /// schedule of the reward. `transitions`: since the start of the training; `late`: share of the
  /// late penalties from now on, 0 to 1.
  WindowStats end_window(double transitions, double late);
  const Curriculum& curriculum() const { return curriculum_; }
  /// As if a training had got this far; what was drawn stays until it is drawn again.
  void set_curriculum(const Curriculum& curriculum, double transitions, double late);
  CommandRange command_range() const;
  /// Of the episodes that end in time, those whose robot goes on as it is.
  void set_soft_reset_share(double share) { config_.episode.soft_reset_share = share; }

  void save(learner::Checkpoint& checkpoint) const;
  void load(const learner::Checkpoint& checkpoint);

 private:
  static constexpr int kPrivileged =
      kObservationSize + kEstimateSize + 4 * kNumLegs + kNumJoints + 8;

  static constexpr int kGroundFeatures = 6;     // that the critic sees
  static constexpr std::size_t kSigmaFlat = 1;  // of them: rises with the stiffness
  static constexpr int kUnloadedSteps = 2;  // after which a foot without a load counts as lifted

  // One environment beside its robot in the batch. Trivially copyable: a checkpoint.
  struct Env {
    std::uint64_t draws = 0;
    std::array<float, 3> command{}, target{};  // target: where the command goes
    std::int32_t stand_steps_left = 0;         // before it does
    std::int32_t step = 0, command_steps_left = 0;
    JointArray<float> action{}, action_1{}, action_2{};  // the latest, and those before it
    sim::SensorErrors sensors;
    std::array<float, kNumLegs> air_s{}, stance_s{}, since_touchdown_s{};
    std::array<std::int32_t, kNumLegs> unloaded_steps{};
    sim::TouchdownWatch touchdowns;
    std::array<float, 3> drift{};  // vx, vy, yaw rate, low-passed
    float noise_level = 1.0f;
    // For the critic: of each patch of ground, and of the robot.
    std::array<TerrainFeatures, sim::kMaxRegions> ground_features{};
    std::array<float, 2> robot_features{};
    std::int32_t latency_ticks = 0;     // of the action, in steps of the simulation
    JointArray<float> newest_target{};  // of the latest action, rad
    sim::BatchDrive<float> drive;
    sim::Terrain<float> terrain;
  };

  // randomise.cpp: what is drawn, and resets.
  double uniform(int env, Env& e) const;  // [0, 1)
  double uniform(int env, Env& e, double low, double high) const;
  double normal(int env, Env& e) const;
  bool is_rigid(int env) const { return env % block_envs_ < config_.ground.rigid_envs; }
  /// The kind of ground by which the curricula go: that which yields, if there is any.
  int decisive_kind() const { return config_.ground.rigid_envs < block_envs_ ? 1 : 0; }
  bool is_patchy(int env) const {
    return env % block_envs_ >= block_envs_ - config_.ground.patchy_envs;
  }
  void new_command(int env, Env& e) const;
  void approach_target(Env& e) const;
  sim::ShapeParameters draw_shape(int env, Env& e) const;
  sim::Ground<double> draw_ground(int env, Env& e, bool rigid, sim::ShapeParameters& shape,
                                  TerrainFeatures& features) const;
  void new_ground(int env, Env& e, float x_m, sim::ShapeParameters shape);
  void new_robot(int env, Env& e);
  void new_joints(int env, Env& e, sim::RobotModel<double>& model) const;
  static void set_latency(Env& e, double latency_s);
  void hard_reset(int env, Env& e, double nominal_share);
  void soft_reset(int env, Env& e, float x_m);
  bool push(int env, Env& e, sim::RobotState<float>& state) const;
  bool loosen(int env, Env& e, sim::RobotState<float>& state) const;

  // observe.cpp: what is shown.
  const TerrainFeatures& features_under(const Env& e, const sim::RobotState<float>& state) const;
  std::array<float, kEstimateSize> truth(const Env& e, const sim::RobotState<float>& state) const;
  void observe_env(int env, int t, learner::Rollout& rollout);
  void policy_input(int env, Env& e, const sim::RobotState<float>& state, float* out) const;
  void privileged(const Env& e, const sim::RobotState<float>& state,
                  const sim::BatchReport<float>& report, float* out) const;

  // task.cpp: a step.
  void set_targets(int env, const float* action);
  StepOutcome follow(Env& e, const sim::RobotState<float>& state,
                     const sim::BatchReport<float>& report,
                     const sim::BatchSums<float>& sums) const;
  void end_step(int env, int t, learner::Rollout& rollout, WindowSums& window);
  void advance_curriculum(const WindowStats& window);

  TaskConfig config_;
  std::uint64_t seed_;
  int block_envs_;
  sim::Robot robot_;
  InputScales scales_;
  sim::FootProfile<double> foot_;
  sim::Batch batch_;
  std::vector<Env> envs_;
  std::vector<WindowSums> sums_;  // one a block
  Curriculum curriculum_;
  RewardSchedule schedule_;
  double tilt_end_cos_;
  StepDetails* details_ = nullptr;
};

}  // namespace sandrunner::train
