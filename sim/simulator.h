// SPDX-License-Identifier: BSD-3-Clause
// The robot in simulation, behind the same interface as the hardware.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "rt/core/robot_io.h"
#include "rt/core/state_hash.h"
#include "sim/ground/terrain_description.h"
#include "sim/step/actuator.h"
#include "sim/step/robot_step.h"

namespace sandrunner::sim {

/// Standard deviations of the white sensor noise added at every sample; all off by default.
struct SensorNoise {
  double joint_position_rad = 0.0;
  double joint_velocity_radps = 0.0;
  double orientation_rad = 0.0;  ///< about each body axis
  double angular_velocity_radps = 0.0;
  double linear_acceleration_mps2 = 0.0;
};

inline constexpr int kMaxDelayTicks = 64;

/// A drive that gets no command for 100 ms goes off until the next one, as real ones do.
inline constexpr std::uint64_t kDriveTimeout_ticks = kControlHz / 10;

struct SimulatorConfig {
  TerrainDescription terrain;
  SensorNoise noise;
  int sensor_delay_ticks = 0;         ///< age of what read() delivers, 0..63
  int actuator_delay_ticks = 0;       ///< ticks until a command acts, 0..63
  TorqueSpeedLine torque_speed_line;  ///< of the drives; by default none
  StepSettings step;
  std::uint64_t seed = 0;
};

/// The complete state: a copy is a snapshot. Every member is 64 bits wide, so there is no padding.
struct SimulatorState {
  std::uint64_t tick = 0;
  RobotState<double> robot;
  JointArray<double> torque_nm{};  ///< of the last step
  Vector3 linear_acceleration_mps2{0.0, 0.0,
                                   kGravity_mps2};    ///< what the IMU's accelerometer feels
  std::array<SensorFrame, kMaxDelayTicks> sensors{};  ///< ring by tick; used with a delay
  std::array<SafeCommand, kMaxDelayTicks> commands{};
  Footprints footprints;  ///< used where the terrain keeps them
};
static_assert(std::is_trivially_copyable_v<SimulatorState>);

class Simulator final : public RobotIo {
 public:
  Simulator(const Robot& robot, const SimulatorConfig& config);

  /// On its feet in the nominal pose, at rest, base at the robot's nominal height (`--start walk`);
  /// on a slope square on its plane, on uneven ground so high that its lowest part is 2 mm above
  /// it. A seed above 0 disturbs this:
  /// joints +-0.1 rad, base velocity +-0.1 m/s and +-0.1 rad/s, the lowest part 2 mm above the
  /// ground; uniform draws from the seed.
  void reset_standing();
  /// On its belly in the lying pose, at rest; disturbed in the same way, but touching the ground.
  void reset_lying();

  // What the viewer does to the robot and its ground between two ticks; time goes on.
  /// Gives the whole robot this much more speed, world frame, m/s: a push that is over at once.
  void push(double vx_mps, double vy_mps) noexcept;
  /// For a tick, moves the robot as a careful hand does towards its nominal pose, level and just
  /// above the ground where it is; no faster than encoders and IMU can follow. True: it is there.
  bool carry_to_stand() noexcept;
  /// Other ground, with the feet as they were. Where it is of another kind, or springs of another
  /// stiffness, the robot is lifted out of its holes, or hard ground would throw it up.
  void set_terrain(const TerrainDescription& terrain);

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override;
  /// Takes the command and advances the robot by one tick.
  void write(const SafeCommand& command) noexcept override;
  /// Advances the robot by one tick under these torques: its drives are outside of the simulator.
  void step(const JointArray<double>& torque_nm) noexcept;
  /// Simulates the missed ticks, so that simulated time stays on the grid.
  void skip(std::uint64_t ticks, const SafeCommand& held) noexcept override;
  void cut_drives() noexcept override { cut_.store(true, std::memory_order_relaxed); }
  void shut_down() noexcept override {}
  bool truth(RobotTruth& truth) const noexcept override;

  const SimulatorState& state() const noexcept { return state_; }
  void restore(const SimulatorState& state) noexcept;
  void add_to(StateHash& hash) const noexcept override;

  ImuSample imu() const noexcept;  ///< as of a sensor without noise and delay
  const StepReport<double>& report() const noexcept { return report_; }  ///< of the last step
  const RobotModel<double>& model() const noexcept { return robot_.model; }
  const Terrain<double>& terrain() const noexcept { return terrain_; }
  Relief<double> relief() const noexcept { return {{config_.terrain.shape.heights.get()}}; }
  /// Height of the undisturbed surface, m.
  double surface_height(double x_m, double y_m) const noexcept;

 private:
  void disturb(double height_above_m);
  SensorFrame sample() const noexcept;

  Robot robot_;
  SimulatorConfig config_;
  FootProfile<double> foot_;
  Terrain<double> terrain_;
  bool remembers_;  // the terrain keeps footprints
  DriveLine<double> line_;
  RobotStepper<double> stepper_;
  SimulatorState state_;
  StepReport<double> report_;
  std::atomic<bool> cut_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

/// Reads the table [sim] of `config` and its terrain; figures of the drives are `robot`'s unless
/// set. Throws InputError.
SimulatorConfig read_simulator_config(ConfigTree& config, const Robot& robot);
/// The keys of the table [sim], for the reference.
std::vector<SettingLine> simulator_settings();

}  // namespace sandrunner::sim
