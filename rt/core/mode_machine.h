// SPDX-License-Identifier: BSD-3-Clause
// The modes of the controller and every way from one to another.
//
// clang-format off
//            | arm      damp     stop     lie       passive  stand    walk     reset      | stood up  stopped  lowered | fault
//   ---------+---------------------------------------------------------------------------+---------------------------+------
//   Passive  | Damping  .        .        .         .        .        .        .          | .         .        .       | Fault
//   Damping  | .        .        .        .         Passive  StandUp  .        .          | .         .        .       | Fault
//   StandUp  | .        Damping  Damping  Stand(3)  .        .        .        .          | Stand     .        .       | Fault
//   Stand    | .        Damping  (5)      (3)       .        (4)      Walk(4)  .          | .         .        Damping | Fault
//   Walk     | .        Damping  (1)      (1,3)     .        (1)      .        .          | .         Stand    .       | Fault
//   Fault    | .        .        .        .         .        .        .        Passive(2) | .         .        .       | .
// clang-format on
//
// "." stays. Two steps from rest to motion: arm switches the drives on, which only brake, stand
// lets them move. A robot that carries itself goes to Passive only through Damping: it is let down,
// not dropped.
//
// (1) Starts a stop: the command goes to zero, the policy walks on until the robot has stopped.
//
// (2) Only when the drives are off and no condition for a fault holds any more (controller.h). The
// robot then stays Passive until the next request: a reset never re-arms.
//
// (3) Stand lowers the body: the legs fold, then it damps. A robot that lies on the ground, as in
// the first motion of StandUp, goes to Damping at once, and so does one whose stiffness still
// rises, and one that leans by more than 20 degrees, as stiff legs would topple it.
//
// (4) While the body is lowered, Stand raises it again, and Walk is ignored until that is done.
//
// (5) While the body is lowered or raised again, Stop damps. Before, it takes back a Lie.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "rt/core/messages.h"

namespace sandrunner {

/// What can change the mode: a request of the operator, an end that was reached, a fault.
enum class Event : std::uint64_t {
  kRequestPassive,
  kRequestDamp,
  kRequestStand,
  kRequestWalk,
  kRequestReset,
  kRequestArm,
  kRequestStop,
  kRequestLie,
  kStoodUp,
  kStopped,
  kLowered,
  kFault,
};
inline constexpr int kNumEvents = 12;

/// A request of an operator.
struct RequestRow {
  ModeRequest request;
  Event event;
  const char* name;  ///< over DDS, on the command line, in pages and recordings
  char key;          ///< in pages and in sandrunner-ctl drive; 0: none
  bool calms;        ///< it ends the motion
};

/// Every request, in the order in which people see them.
inline constexpr std::array<RequestRow, 8> kRequestTable = {{
    {ModeRequest::kArm, Event::kRequestArm, "arm", 'r', false},
    {ModeRequest::kStand, Event::kRequestStand, "stand", 'g', false},
    {ModeRequest::kWalk, Event::kRequestWalk, "walk", 'f', false},
    {ModeRequest::kStop, Event::kRequestStop, "stop", ' ', true},
    {ModeRequest::kLie, Event::kRequestLie, "lie", 0, false},
    {ModeRequest::kDamp, Event::kRequestDamp, "damp", 'x', true},
    {ModeRequest::kPassive, Event::kRequestPassive, "disarm", 0, false},
    {ModeRequest::kResetFault, Event::kRequestReset, "reset_fault", 0, false},
}};

/// Null: there is none, as for ModeRequest::kNone.
const RequestRow* row_of(ModeRequest request) noexcept;
const RequestRow* request_named(std::string_view name) noexcept;

struct Transition {
  Mode from;
  Event event;
  Mode to;
};

inline constexpr std::array<Transition, 18> kTransitions = {{
    {Mode::kPassive, Event::kRequestArm, Mode::kDamping},
    {Mode::kPassive, Event::kFault, Mode::kFault},
    {Mode::kDamping, Event::kRequestPassive, Mode::kPassive},
    {Mode::kDamping, Event::kRequestStand, Mode::kStandUp},
    {Mode::kDamping, Event::kFault, Mode::kFault},
    {Mode::kStandUp, Event::kRequestDamp, Mode::kDamping},
    {Mode::kStandUp, Event::kRequestStop, Mode::kDamping},
    {Mode::kStandUp, Event::kRequestLie, Mode::kStand},
    {Mode::kStandUp, Event::kStoodUp, Mode::kStand},
    {Mode::kStandUp, Event::kFault, Mode::kFault},
    {Mode::kStand, Event::kRequestDamp, Mode::kDamping},
    {Mode::kStand, Event::kRequestWalk, Mode::kWalk},
    {Mode::kStand, Event::kLowered, Mode::kDamping},
    {Mode::kStand, Event::kFault, Mode::kFault},
    {Mode::kWalk, Event::kRequestDamp, Mode::kDamping},
    {Mode::kWalk, Event::kStopped, Mode::kStand},
    {Mode::kWalk, Event::kFault, Mode::kFault},
    {Mode::kFault, Event::kRequestReset, Mode::kPassive},
}};

/// The mode after `event` in `mode`: that of the table, else `mode`.
Mode next_mode(Mode mode, Event event) noexcept;

/// "passive", "damping", "stand_up", "stand", "walk", "fault".
const char* mode_name(Mode mode) noexcept;

}  // namespace sandrunner
