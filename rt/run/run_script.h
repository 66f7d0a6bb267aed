// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/core/gate_config.h"
#include "rt/loop/operator_input.h"
#include "rt/operator/gentle_end.h"
#include "rt/run/command_source.h"

namespace sandrunner {

struct RunResult;

/// What the run is to be.
struct RunPlan {
  double walk_s = 20.0;
  bool start_walking = false;  ///< at once in Walk from the nominal pose; ends in Walk
};

/// Why a robot may not walk; null: it may.
inline const char* no_walk(const GateConfig& gate, bool has_policy) noexcept {
  if (gate.hanging) return "the robot hangs (hardware.hanging), it may not walk";
  return has_policy ? nullptr : "no policy to walk with";
}

/// The operator of a run from the command line: stands the robot up, lets it settle and walk, stops
/// it, waits, and lets it lie down, as after an interrupt; or just walks. After a fall, a fault or
/// a second interrupt it damps at once. A robot that may not walk only stands up, and lies down.
class RunScript final : public OperatorInput {
 public:
  /// `command` must outlive the script.
  RunScript(const CommandSource& command, const RunPlan& plan, bool can_walk);

  OperatorCommand command(std::uint64_t tick) noexcept override;
  OperatorVerdict advance(const TickFacts& facts) noexcept override;

  /// Enters what became of the run under this script. In run.cpp.
  void report(RunResult& result) const;

  bool survived() const noexcept { return fall_reason_ == nullptr; }
  /// "base_contact", "thigh_contact", "did_not_stand", or the name of a fault or a warning; null:
  /// none.
  const char* fall_reason() const noexcept { return fall_reason_; }
  double fall_time_s() const noexcept { return fall_time_s_; }  ///< since the start of Walk
  Mode fall_mode() const noexcept { return fall_mode_; }        ///< in which it fell or faulted
  bool interrupted() const noexcept { return interrupted_; }
  /// Time in Walk under the command.
  double walked_s() const noexcept { return static_cast<double>(walked_) * kControlPeriod_s; }

 private:
  enum WayDown { kAtOnce, kGently };
  enum class Phase { kArm, kStandUp, kWalk, kStop, kEnd };
  void enter(Phase phase) noexcept;
  void end(ModeRequest r) noexcept;
  void fail(const char* reason, WayDown way) noexcept;
  AfterTick next_phase(Mode mode, std::uint64_t ticks) noexcept;

  const CommandSource& source_;
  const RunPlan plan_;
  const bool can_walk_;
  const std::uint64_t walk_ticks_;
  Phase phase_;
  OperatorCommand command_;
  GentleEnd end_;
  std::uint64_t standing_ = 0, walked_ = 0;
  bool has_walked_, interrupted_ = false, warned_ = false;
  const char* fall_reason_ = nullptr;
  double fall_time_s_ = 0.0;
  Mode fall_mode_;  // until it falls: the last mode that was not Fault
};

}  // namespace sandrunner
