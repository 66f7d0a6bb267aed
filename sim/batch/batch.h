// SPDX-License-Identifier: BSD-3-Clause
// Many robots at once: packs of 8 or 16 robots in SIMD lanes (or one at a time), each with its own
// inertia, ground, drives and delay. A robot's trajectory has the same bits at every width, in
// every lane, next to any neighbours.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sim/step/actuator.h"
#include "sim/step/robot_step.h"

namespace sandrunner::sim {

/// What a robot's drives do during one policy period.
template <typename S>
struct BatchDrive {
  std::array<S, kNumJoints> target_before{};  ///< joint targets until `switch_tick`, rad
  std::array<S, kNumJoints> target{};         ///< joint targets from then on, rad
  S switch_tick{};          ///< ticks into the period at which the new targets arrive
  S kp{}, kd{};             ///< of all joints, N m/rad, N m s/rad
  S torque_scale = S(1.0);  ///< delivered over commanded torque
  DriveLine<S> line;        ///< by default none
  /// Of HAA, HFE and KFE (estimator/cost_of_transport.h).
  LegJoints<S> heat_factor{S(1.0), S(1.0), S(1.0)};
};

/// Share of a joint's speed limit above which a speed counts in `speed_excess`.
inline constexpr double kSpeedMargin = 0.9;

/// A foot is loaded when it carries more than this on average over one of the last two policy
/// steps: on sand the normal force comes in pulses.
inline constexpr float kLoaded_n = 3.0f;

/// Sums over the ticks of one policy period, for rewards and statistics.
template <typename S>
struct BatchSums {
  S torque_squared{};  ///< sum over joints of (heat factor times tau)^2, N^2 m^2
  S power{};           ///< signed sum of tau qd, W
  /// Sum over HFE and KFE of max(tau, 0) max(qd, 0), W: legs that push off extend both.
  S extension_power{};
  S speed_squared{};  ///< sum over joints of qd^2, rad^2/s^2
  S speed_excess{};   ///< sum over joints of (|qd| - kSpeedMargin limit)+^2, rad^2/s^2
  S ticks_too_fast{}, ticks_past_stop{};  ///< ticks with any such joint
  S slip{};                               ///< sum over feet in contact of |v_xy|^2, m^2/s^2
  std::array<S, kNumLegs> foot_load{};    ///< normal force of each foot, N
  S base_contact{}, thigh_contact{};      ///< 1: touched the ground in the period
};

/// The last tick of the period.
template <typename S>
struct BatchReport {
  std::array<Vec3<S>, kNumLegs> foot_velocity;  ///< of the contact point, world, m/s
  std::array<S, kNumLegs> penetration{};        ///< m
  std::array<std::array<S, 3>, kNumLegs>
      foot_force{};  ///< on the robot, contact frame (world axes on level ground), N
};

/// All of one robot, as it is written and read.
template <typename S>
struct BatchRobot {
  RobotModel<S> model;
  Terrain<S> terrain;
  RobotState<S> state;
  BatchDrive<S> drive;
  BatchSums<S> sums;
  BatchReport<S> report;
};

/// Robots in a pack: 1, 8 (AVX2, NEON) or 16 (AVX-512).
enum class BatchWidth : int { kOne = 1, kEight = 8, kSixteen = 16 };
/// The widest that this processor can run.
BatchWidth best_batch_width() noexcept;

namespace detail {
/// The code for one width; each comes from a source compiled for its instruction set.
struct BatchKernel {
  int width;
  std::size_t pack_bytes, pack_alignment;
  void (*construct)(void* pack);
  /// `heights`, `prints`: of each lane's ground, or null.
  void (*advance)(void* pack, const FootProfile<double>& foot, const StepSettings& settings,
                  const HeightGrid* const* heights, Footprints* const* prints, int ticks);
};
const BatchKernel& batch_kernel_x1() noexcept;
const BatchKernel& batch_kernel_x8() noexcept;
const BatchKernel& batch_kernel_x16() noexcept;
}  // namespace detail

/// A batch of robots with one kind of foot. Robots are written and read one by one, in float; packs
/// advance independently of each other, so that threads may share them.
class Batch {
 public:
  /// Throws std::invalid_argument if the processor cannot run the width.
  Batch(int robots, const FootProfile<double>& foot, const StepSettings& settings,
        BatchWidth width = best_batch_width());

  int size() const noexcept { return robots_; }
  /// Robots in a pack.
  int width() const noexcept { return kernel_.width; }
  int packs() const noexcept { return (robots_ + width() - 1) / width(); }

  void set_model(int robot, const RobotModel<float>& model) noexcept;
  /// Where the kind of ground changes under feet in contact, their FootContact is to be reset.
  void set_terrain(int robot, const Terrain<float>& terrain) noexcept;
  /// Heights from a file, to a terrain whose shape has them; they must outlive their use.
  void set_heights(int robot, const HeightGrid* heights);
  /// Where a terrain that keeps footprints keeps them; must outlive its use. Without, it keeps
  /// none.
  void set_footprints(int robot, Footprints* prints);
  void set_state(int robot, const RobotState<float>& state) noexcept;
  void set_drive(int robot, const BatchDrive<float>& drive) noexcept;
  RobotState<float> state(int robot) const noexcept;
  /// Everything of one robot, for checkpoints.
  BatchRobot<float> robot(int robot) const noexcept;
  void set_robot(int robot, const BatchRobot<float>& all) noexcept;
  BatchSums<float> sums(int robot) const noexcept;
  BatchReport<float> report(int robot) const noexcept;

  /// Advances all robots of a pack by `ticks` steps of `StepSettings::dt_s`; their sums start at
  /// zero. The calling thread must flush denormals (flush_denormals_to_zero()).
  void advance(int pack, int ticks) noexcept;

 private:
  struct Free {
    void operator()(std::byte* memory) const noexcept;
  };
  std::size_t state_bytes() const noexcept;
  template <typename Pointer>
  void put(Pointer pointer, int robot, std::vector<Pointer>& of_lanes) const;
  // Where a robot's number at `offset` of a BatchRobot is; the next is `width()` floats behind it.
  std::byte* lane(int robot, std::size_t offset) const noexcept;
  void copy_in(int robot, std::size_t offset, const void* values, std::size_t bytes) noexcept;
  template <typename Value>
  Value copy_out(int robot, std::size_t offset, std::size_t bytes = sizeof(Value)) const noexcept;

  int robots_;
  FootProfile<double> foot_;
  StepSettings settings_;
  const detail::BatchKernel& kernel_;
  std::unique_ptr<std::byte[], Free> memory_;
  std::vector<const HeightGrid*> heights_;  // of each lane; empty: none
  std::vector<Footprints*> prints_;         // likewise
};

}  // namespace sandrunner::sim
