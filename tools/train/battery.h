// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "rt/base/worker_pool.h"
#include "sim/robot/robot_model.h"
#include "tools/train/learner/block_pass.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {

inline constexpr std::size_t kForwardSpeeds = 5;

/// Table `battery` of tools/train/training.toml.
struct BatterySettings {
  int every_updates = 0;  ///< between evaluations; 0: no evaluation
  int runs = 0;  ///< of each forward speed on each ground; half of them of the other commands
  double duration_s = 0.0;                             ///< of a run
  std::array<double, kForwardSpeeds> forward_share{};  ///< of the largest commanded speed
  double softest_flat_npm3 = 0.0;                      ///< stiffness of the softest soil, ...
  double softest_cone_npm3 = 0.0;                      ///< ... limited to those of the training
  double softest_spring_npm = 0.0;                     ///< of a training on springs; likewise
  double tracked_error = 0.0;    ///< most tracking error of a policy that tracks its commands
  double too_fast_weight = 0.0;  ///< in the score, in units of the cost of transport
  double drift_weight = 0.0;     ///< in the score, per m/s
};

/// What the battery measures of a policy. Trivially copyable: part of checkpoints. All but the
/// survival are means over the runs that survive, 0 or nan if there is none. "Steady" is the second
/// half of a run.
struct BatteryFigures {
  double alive = 0.0;  ///< share of the runs without a fall
  /// Error of the steady mean velocity over the commanded one, 0.5 m/s counted for 1 rad/s.
  double error = 0.0;
  double cost_of_transport = std::numeric_limits<double>::quiet_NaN();  ///< of forward runs
  double too_fast = 0.0;         ///< share of time in which a joint is above its speed limit
  double drift_mps = 0.0;        ///< steady mean |vy| of forward runs
  double yaw_drift_radps = 0.0;  ///< steady mean |yaw rate| of forward runs
  std::array<double, kForwardSpeeds> alive_at{};              ///< of forward runs, slowest first
  std::array<double, kForwardSpeeds> cost_of_transport_at{};  ///< likewise
};

/// Policies survive alike whose shares of runs without a fall differ by no more than this: two runs
/// of 225, about what other starts would change (one standard deviation).
inline constexpr double kAlike = 0.01;

/// The number by which the policies of a training are compared; larger is better. `most_alive` is
/// the largest share that survived the battery so far. A fall more than `kAlike` allows counts more
/// than any cost of transport, and so does an error of 0.005 beyond `tracked_error`: a robot that
/// stands still gets nowhere. Of policies that survive and track alike the cheaper is better:
///   -(1000 max(0, most_alive - kAlike - alive) + 1000 max(0, error - tracked_error)
///     + cost of transport + too_fast_weight too_fast
///     + drift_weight (drift + 0.5 m yaw drift))
double score_of(const BatteryFigures& figures, const BatterySettings& settings, double most_alive);

/// A fixed set of runs by which a training judges its policy: from rest to steady running forward
/// at several speeds, backwards, sideways and turning, without noise or pushes, on the hard ground
/// and those soils or springs that the training has. The runs are episodes of a Task of its own, so
/// that the training's random draws stay as they are. Robots are the nominal one, with the
/// training's delays; soils have the usual inertia, if the training has it. Same weights: same
/// figures, bit for bit, for any number of threads.
class Battery {
 public:
  /// `block_envs`: of the training, whose ground settings count environments of a block. `pool`
  /// must outlive it.
  Battery(const BatterySettings& settings, const TaskConfig& training, int block_envs,
          const sim::Robot& robot, const learner::ParameterLayout& layout, WorkerPool& pool);

  Battery(const Battery&) = delete;
  Battery& operator=(const Battery&) = delete;

  /// Runs the policy with these parameters of the layout; the ranks share the runs. Not from within
  /// a task of the pool.
  BatteryFigures run(const std::vector<float>& parameters, const learner::Ranks& ranks = {});

  /// After `run`, of each ground: how many of the forward runs, slowest first, did not fall.
  struct Survival {
    std::string ground;
    std::array<int, kForwardSpeeds> alive{};
  };
  std::vector<Survival> survival() const;

  /// The names of the grounds.
  std::vector<std::string> grounds() const;

 private:
  struct Ground {
    std::string name;
    sim::Terrain<float> terrain;
    TerrainFeatures features;
  };
  struct Run {
    Trial trial;
    int speed = -1;  // index of a forward speed, or none
  };
  // Sums of a run.
  struct Sums {
    bool fell = false;
    std::array<double, 3> velocity{}, command{};
    double power = 0.0, torque_squared = 0.0, too_fast = 0.0;
  };

  static std::deque<Ground> make_grounds(const BatterySettings& settings,
                                         const GroundSettings& training, int block_envs,
                                         const sim::Robot& robot);
  static std::vector<Run> make_runs(const BatterySettings& settings, const TaskConfig& training,
                                    const std::deque<Ground>& grounds);
  void run_block(int block, int worker);
  void add_step(int env, const std::array<float, 3>& command, bool steady);
  BatteryFigures figures() const;

  BatterySettings settings_;
  sim::Robot robot_;
  std::deque<Ground> grounds_;  // runs point into it
  std::vector<Run> runs_;
  int steps_;
  Task task_;
  learner::Rollout rollout_;
  learner::Weights<float> weights_;
  std::vector<learner::BlockPass<float>> passes_;  // one a worker
  WorkerPool& pool_;
  learner::Matrix<float> memory_;
  std::vector<Sums> sums_;  // one an environment
};

}  // namespace sandrunner::train
