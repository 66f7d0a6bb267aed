// SPDX-License-Identifier: BSD-3-Clause
// One step (0.25 ms; in trainings 0.5) of a robot on its ground: dynamics, contact law of each
// foot, contact problem, semi-implicit Euler. No clock, no heap, and no branch that depends on one
// lane; instantiated for double (the simulator behind RobotIo) and for float and float packs
// (training).
#pragma once

#include <array>
#include <type_traits>

#include "sim/ground/footprints.h"
#include "sim/ground/height_grid.h"
#include "sim/ground/terrain.h"
#include "sim/robot/dynamics.h"
#include "sim/step/contact_solver.h"

namespace sandrunner::sim {

// Contact points: feet, or the first patch of each, then knees (thigh), shanks, corners of the
// base.
inline constexpr int kNumBaseCorners = 8;
inline constexpr int kNumPoints = 3 * kNumLegs + kNumBaseCorners;
/// Patches of feet beyond the first, patch by patch: points as well, behind the others.
inline constexpr int kNumFurtherPatches = (kMaxFootPatches - 1) * kNumLegs;
inline constexpr int kMaxPoints = kNumPoints + kNumFurtherPatches;
static_assert(Footprints::kMost == kNumLegs + kNumFurtherPatches);
/// Numbers of feet and their patches, patch by patch: below kNumLegs the first of each leg.
constexpr int patch_number(int leg, int patch) noexcept { return patch * kNumLegs + leg; }

/// All that one robot's step carries over to the next.
template <typename S>
struct RobotState {
  RigidState<S> rigid;
  std::array<FootContact<S>, kNumLegs> feet;
  std::array<std::array<S, 3>, kNumPoints> impulse{};  ///< of the last step: warm start, N s
  std::array<S, kNumJoints> stop_impulse{};            ///< signed: > 0 at the lower stop
  /// Likewise, of feet with several patches.
  std::array<FootContact<S>, kNumFurtherPatches> further_feet;
  std::array<std::array<S, 3>, kNumFurtherPatches> further_impulse{};

  FootContact<S>& contact(int leg, int patch) noexcept {
    const int i = patch_number(leg, patch);
    return i < kNumLegs ? feet[i] : further_feet[i - kNumLegs];
  }
  const FootContact<S>& contact(int leg, int patch) const noexcept {
    return const_cast<RobotState&>(*this).contact(leg, patch);
  }
  std::array<S, 3>& impulse_of(int point) noexcept {
    return point < kNumPoints ? impulse[point] : further_impulse[point - kNumPoints];
  }
  /// As if it had never touched the ground.
  void forget_contacts() noexcept {
    feet = {};
    further_feet = {};
    impulse = {};
    further_impulse = {};
  }
};

/// What sensors, statistics, rewards and pictures need to know of a step.
template <typename S>
struct StepReport {
  std::array<Vec3<S>, kNumLegs> foot_centre;  ///< world, m, at the start of the step
  std::array<S, kNumLegs> penetration{};      ///< of the deepest point below the surface, m
  std::array<S, kNumLegs> heaped{};  ///< of that surface over the undisturbed one (Footprints), m
  std::array<Vec3<S>, kNumLegs> foot_velocity;  ///< of the deepest point, world, m/s
  std::array<std::array<S, 3>, kNumLegs>
      foot_force{};                     ///< contact frame (world axes on level ground), N
  std::array<S, kNumLegs> raw_force{};  ///< granular law before the filter, N
  std::array<Vec3<S>, kNumLegs> knee;   ///< world, m
  S base_contact{}, thigh_contact{};    ///< 1: touches the ground
  Vec3<S> base_acceleration;            ///< of the base origin, body components, m/s^2
  int sweeps = 0;
};

struct StepSettings {
  double dt_s = kControlPeriod_s;
  double tolerance_ns = 1e-5;  ///< of the contact solver, N s
  int max_sweeps = 150;
};

template <typename S>
class RobotStepper {
 public:
  /// Advances `x` by one step under joint torques (N m). `relief`: heights from files, of lanes
  /// whose shapes have them; `prints`: of lanes whose ground keeps them, which writes them.
  void step(const RobotModel<S>& model, const FootProfile<S>& foot, const Terrain<S>& terrain,
            const StepSettings& settings, const std::array<S, kNumJoints>& torque_nm,
            RobotState<S>& x, StepReport<S>& report, const Relief<S>& relief = {},
            const Prints<S>& prints = {}) noexcept;

  /// The contact problem of the last step as solved, for tests.
  const std::array<PointContact<S>, kMaxPoints>& points() const noexcept { return points_; }
  int num_points() const noexcept { return num_points_; }

 private:
  struct Frame {  // rows in body components
    Vec3<S> t1, t2, n;
  };
  /// A ball of the base, or of the leg that its first `joints` joints move.
  struct HardPoint {
    Vec3<S> r_base{}, r_hip{};  ///< from the base origin and, of a leg, from its hip
    S radius{};
    int leg = -1, joints = 0;  ///< -1: of the base
    bool only_hard = false;    ///< ground that yields does not touch it
    int slot = 0;              ///< of its impulse in RobotState
  };
  struct FootPatch {
    FootForce<S> force;
    S depth{};
  };
  /// Its patch_number() from the slot of its point, and back.
  static constexpr int patch_of(int slot) noexcept {
    return slot < kNumLegs ? slot : slot - kNumPoints + kNumLegs;
  }
  static constexpr int slot_of(int number) noexcept {
    return number < kNumLegs ? number : number - kNumLegs + kNumPoints;
  }
  using Columns = std::array<Vec3<S>, 3>;  // of a leg's Jacobian, body components
  /// Maps an impulse along e (body components) at r_base (from the base origin) to the base and the
  /// joints.
  void fill_row(const Vec3<S>& e, const Vec3<S>& r_base, int leg, const Columns& columns,
                std::array<S, 6>& w, std::array<S, 3>& j) noexcept;
  void fill_rows(const Vec3<S>& r_base, int leg, const Columns& columns, const Frame& frame,
                 PointContact<S>& c) noexcept;
  Vec3<S> foot_in_hip(const RobotModel<S>& model, const FootProfile<S>& foot, int leg,
                      int patch) const noexcept;
  void add_feet(const RobotModel<S>& model, const FootProfile<S>& foot, const Terrain<S>& terrain,
                S dt, RobotState<S>& x, StepReport<S>& report) noexcept;
  [[gnu::always_inline]] void add_foot(const RobotModel<S>& model, const FootProfile<S>& foot,
                                       const Terrain<S>& terrain, S dt, int leg, int patch,
                                       RobotState<S>& x, StepReport<S>& report) noexcept;
  void couple_feet(const Terrain<S>& terrain, const FootProfile<S>& foot, S dt,
                   StepReport<S>& report) noexcept;
  void add_body_points(const RobotModel<S>& model, const Terrain<S>& terrain, RobotState<S>& x,
                       StepReport<S>& report) noexcept;
  void add_hard_point(const RobotModel<S>& model, const Terrain<S>& terrain, const HardPoint& point,
                      const Mask<S>& near, RobotState<S>& x, S& touched) noexcept;
  void add_stops(const RobotModel<S>& model, S dt, const RobotState<S>& x) noexcept;
  Frame contact_frame(const Shape<S>& shape, const Surface<S>& surface) const noexcept;
  void lay_along(const Shape<S>& shape, const Mask<S>& along, const Vec3<S>& position,
                 const Vec3<S>& r_base, const Vec3<S>& v_base, const Frame& frame,
                 FootMotion<S>& m) const noexcept;

  S rate_{};  // steps per second
  Dynamics<S> dynamics_;
  Mat3<S> rotation_;  // body to world
  Vec3<S> velocity_;  // of the base origin, body components
  Motion<S> free_;    // velocities at the end of the step without contact
  std::array<PointContact<S>, kMaxPoints> points_;
  std::array<int, kMaxPoints> slots_{};
  int num_points_ = 0;
  std::array<StopRow<S>, kNumJoints> stops_;
  std::array<int, kNumJoints> stop_joints_{};
  int num_stops_ = 0;
  std::array<FootPatch, static_cast<std::size_t>(kMaxFootPatches) * kNumLegs> patches_;
  Relief<S> relief_;
  Prints<S> prints_;
  Ground<S> mixed_ground_;  // of lanes that stand on different patches
};

}  // namespace sandrunner::sim

#include "sim/step/robot_step_impl.h"
