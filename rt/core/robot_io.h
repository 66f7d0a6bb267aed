// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <type_traits>

#include "rt/core/messages.h"
#include "rt/core/robot_truth.h"
#include "rt/core/state_hash.h"

namespace sandrunner {

/// A joint command that has passed the safety gate. Nothing else can make one: anybody may copy it,
/// and the default one switches the drives off.
class SafeCommand {
 public:
  SafeCommand() = default;

  const JointCommand& joints() const noexcept { return joints_; }
  /// False: the drives are to be without torque, whatever `joints()` says (it is then zero).
  bool enabled() const noexcept { return enabled_ != 0; }
  /// Joints whose measured values are not to be trusted, bit j for joint j. They get no torque, as
  /// damping by a wrong speed would drive; only a drive that closes the loop itself and has gone
  /// silent damps by its own encoder, as it may still hear.
  std::uint64_t blind_joints() const noexcept { return blind_joints_; }

 private:
  friend class SafetyGate;
  SafeCommand(const JointCommand& joints, bool enabled, std::uint64_t blind_joints) noexcept
      : joints_(joints), enabled_(enabled ? 1 : 0), blind_joints_(blind_joints) {}

  JointCommand joints_;
  std::uint64_t enabled_ = 0;  // as wide as the rest: no padding in a recording
  std::uint64_t blind_joints_ = 0;
};
static_assert(std::is_trivially_copyable_v<SafeCommand>);
static_assert(sizeof(SafeCommand) == sizeof(JointCommand) + 16, "no padding");

/// The robot as the control loop sees it: real drives and IMU, or the simulator. Called from the
/// control thread, in each tick: `read`, `Controller::step`, `write`. Time comes from the loop:
/// tick n is due n x 0.25 ms after the start.
class RobotIo {
 public:
  virtual ~RobotIo() = default;

  /// Delivers the newest sensor values in tick `tick` (`frame.tick`). What did not arrive keeps its
  /// old value and tick.
  virtual void read(std::uint64_t tick, SensorFrame& frame) noexcept = 0;

  /// Sends the command. It holds until the next one.
  virtual void write(const SafeCommand& command) noexcept = 0;

  /// The loop missed `ticks` ticks, through which `held`, the last command, has been in force. A
  /// real robot has moved meanwhile; a simulated one moves now.
  virtual void skip([[maybe_unused]] std::uint64_t ticks,
                    [[maybe_unused]] const SafeCommand& held) noexcept {}

  /// The last line: drives off now and for good, `drives_cut` in every frame from now on. From any
  /// thread, also while another call hangs, and from a signal handler: async-signal-safe.
  virtual void cut_drives() noexcept = 0;

  /// The loop ends: drives off. Called once, after the last write().
  virtual void shut_down() noexcept = 0;

  /// What really is, after the last write(). False where nobody knows (a real robot): `truth` is
  /// then as it was.
  virtual bool truth([[maybe_unused]] RobotTruth& truth) const noexcept { return false; }

  /// Adds all that decides what the robot will do to `hash`; nothing where that is not known.
  virtual void add_to([[maybe_unused]] StateHash& hash) const noexcept {}
};

}  // namespace sandrunner
