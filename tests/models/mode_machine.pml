// SPDX-License-Identifier: BSD-3-Clause
// Controller::step (rt/core/controller.cpp) with the mode machine and the gate's latch, and
// RobotIo::write with the watchdog's cut (drivers/robot/can_robot.cpp). Each motion and each wait
// takes a few ticks. Whatever sensors, operator and clock may do is a free choice in each tick.
//
// mistake LATCH_LEAKS: off_or_brakes
// mistake RESET_REARMS: armed
// mistake STAND_ARMS: armed
// mistake ARMS_BY_ITSELF: armed
// mistake FAULT_SWITCHES_ON: armed
// mistake RESET_WHILE_DAMPING: reset_when_off
// mistake RESET_IGNORES_POSTURE: reset_when_well
// mistake OUTPUT_FAULT_STAYS_IN_MODE: latched_in_fault
// mistake COMES_BACK_ON: off_for_good
// mistake DISARM_DROPS: let_down
// mistake STANDS_UP_UNASKED: moves_when_asked
// mistake WALKS_WHILE_HANGING: moves_when_asked
// mistake STOP_WALKS_ON: calms
// mistake STOP_LOWERS_ON: calms
// mistake UNKNOWN_WAY: way_of_the_table
// mistake RESET_FORGETS_DOUBT: zero_known
// mistake MEMORY_OF_A_JUDGEMENT: zero_known
// mistake CUT_SEEN_ONCE: cut_is_last
// mistake WATCHDOG_BRAKES: one_owner
// mistake DAMPS_FOR_EVER: fault_ends_off
// mistake STOP_BEGINS_ANEW: stop_ends
// mistake LIE_IS_LOST: lie_ends
// mistake WAITS_FOR_STAND: stand_up_ends
// mistake CUT_IGNORED: cut_stays
#include "mode_table.pml"

// A command of the gate, and what the drives do.
#define OFF 0
#define BRAKES 1
#define STIFF 2
// ControllerState::stopping
#define STOP 1
#define LIE 2
// Ticks of a motion, of the longest wait (stop_time_s, reach_s), and of the damping (fault_s).
#define MOTION 2
#define WAIT 1
#define FAULT_STEPS 2

#define CARRIES(m) ((m) == STAND_UP || (m) == STAND || (m) == WALK)
#define DRIVEN(m) ((m) == DAMPING || CARRIES(m))

bit hanging  // hardware.hanging

// ControllerState
byte mode = PASSIVE
bit entered
byte stopping
bit folding
bit down             // to_rad is the fold
byte motion          // ticks until motion_done()
byte wait            // ticks until a stop or a stand-up takes too long
byte fault_steps     // FAULT_STEPS: the damping is over
bit before_disable   // tick < disable_tick: the clock may jump either way
// GateState
bit latched
byte gate_mode = PASSIVE  // in which the latest judgement left the robot
bit unsure                // a joint may have lost its zero

// The robot
bit misplaced        // a joint has lost its zero
byte command = OFF   // of the gate, in the latest tick
byte drives = OFF    // the last command that they received
bit cut              // cut_drives() was called ...
bit cut_sent         // ... and has sent its frames

// The promises, each of which README.md explains.
bit off_or_brakes = 1
bit armed = 1
bit reset_when_off = 1
bit reset_when_well = 1
bit latched_in_fault = 1
bit off_for_good = 1
bit let_down = 1
bit moves_when_asked = 1
bit calms = 1
bit way_of_the_table = 1
bit zero_known = 1
bit cut_is_last = 1
bit one_owner = 1
// For them: there was an arm since the drives were off; they went off in this fault.
bit arm_given, went_off

ltl fault_ends_off { [] (mode == FAULT -> <> (command == OFF)) }
ltl stop_ends { [] ((mode == WALK && stopping != 0) -> <> !(mode == WALK && stopping != 0)) }
ltl lie_ends { [] ((mode == STAND && stopping == LIE) -> <> !(mode == STAND && stopping == LIE)) }
ltl stand_up_ends { [] (mode == STAND_UP -> <> (mode != STAND_UP)) }
ltl cut_stays { [] (cut_sent -> <> [] (drives == OFF)) }

inline chance(happens) {
  if
  :: happens = 1
  :: happens = 0
  fi
}

inline start_motion(to_fold, ticks) {
  down = to_fold
  motion = ticks
}

inline begin_lowering() {
  stopping = LIE
  folding = 1
  start_motion(1, MOTION)
}

// Of a mode without motion these mean nothing, and the next motion sets them.
inline forget_motion() {
  down = 0; motion = 0; wait = 0
}

inline enter(to) {
  from = (entered -> mode : PASSIVE)
  mode = to
  entered = 1
  if
  :: mode == STAND_UP ->
    stopping = 0
    chance(folding)  // the joints are not near the posture of Stand
    start_motion(folding, MOTION)
    wait = WAIT
  :: mode == STAND && from == WALK && stopping == LIE ->
    folding = 1
    start_motion(1, MOTION)
  :: mode == STAND && from == WALK && stopping != LIE -> start_motion(0, MOTION)
  :: mode == STAND && from != WALK && stopping == LIE -> begin_lowering()
  :: mode == STAND && from != WALK && stopping != LIE -> start_motion(0, 0)
  :: mode == WALK -> stopping = 0
  :: mode == PASSIVE || mode == DAMPING ->
    forget_motion()
    before_disable = 0; fault_steps = 0
  :: else
  fi
}

inline enter_fault() {
#ifdef FAULT_SWITCHES_ON
  before_disable = 1
#else
  before_disable = (entered && mode != PASSIVE)
#endif
  mode = FAULT
  entered = 1
  fault_steps = 0
  forget_motion()
}

#define DRIVES_ON (before_disable && fault_steps < FAULT_STEPS)

// The table, with mistakes.
inline follow_table(mode_before, what, mode_after) {
  next_mode(mode_before, what, mode_after)
  if
#ifdef RESET_REARMS
  :: mode_before == FAULT && what == REQUEST_RESET_FAULT -> mode_after = DAMPING
#endif
#ifdef STAND_ARMS
  :: mode_before == PASSIVE && what == REQUEST_STAND -> mode_after = STAND_UP
#endif
#ifdef DISARM_DROPS
  :: mode_before == STAND && what == REQUEST_DISARM -> mode_after = PASSIVE
#endif
#ifdef UNKNOWN_WAY
  :: mode_before == DAMPING && what == REQUEST_LIE -> mode_after = STAND
#endif
  :: else
  fi
}

inline begin_stop() {
  stopping = STOP
  wait = WAIT
}

// Controller::after_request, for a new request.
inline after_request() {
  next = mode
  if
#ifndef WALKS_WHILE_HANGING
  :: event == REQUEST_WALK && hanging -> skip
#endif
#ifndef RESET_WHILE_DAMPING
  :: mode == FAULT && DRIVES_ON -> skip
#endif
  :: mode == WALK ->
    if
    :: event == REQUEST_STAND || event == REQUEST_STOP || event == REQUEST_LIE ->
#ifndef STOP_WALKS_ON
      if
#ifdef STOP_BEGINS_ANEW
      :: true -> begin_stop()
#else
      :: stopping == 0 -> begin_stop()
      :: else
#endif
      fi
      stopping = (event == REQUEST_LIE -> LIE : STOP)
#else
      skip
#endif
    :: event == REQUEST_WALK -> stopping = 0
    :: else
    fi
    follow_table(mode, event, next)
  :: event == REQUEST_LIE && mode == STAND_UP && (folding || motion > 0) -> next = DAMPING
  :: event == REQUEST_LIE && ((mode == STAND_UP && !folding) || mode == STAND) ->
    stopping = LIE
    follow_table(mode, event, next)
  :: event == REQUEST_STAND && mode == STAND ->
    if
    :: down -> start_motion(0, MOTION)
    :: else
    fi
    stopping = STOP
    follow_table(mode, event, next)
  :: event == REQUEST_WALK && mode == STAND && folding && !hanging -> skip
#ifndef STOP_LOWERS_ON
  :: event == REQUEST_STOP && mode == STAND ->
    if
    :: folding -> next = DAMPING
    :: else -> stopping = STOP
    fi
#endif
  :: else -> follow_table(mode, event, next)
  fi
}

// Controller::after_time, if no request has changed the mode.
inline after_time() {
  ends = NO_EVENT
  if
  :: mode == STAND_UP && !folding && motion == 0 ->
    chance(happens)  // the joints are where they should be
    ends = (happens -> STOOD_UP : NO_EVENT)
  :: mode == STAND ->
    chance(happens)  // the operator is lost
    if
    :: happens && event == NO_EVENT -> stopping = LIE
    :: else
    fi
    chance(happens)  // the robot leans
    if
    :: stopping == LIE && happens -> ends = REQUEST_DAMP
    :: stopping == LIE && !happens && motion == 0 && down ->
#ifdef LIE_IS_LOST
      skip
#else
      ends = LOWERED
#endif
    :: stopping == LIE && !happens && motion == 0 && !down -> begin_lowering()
    :: stopping != LIE && motion == 0 -> folding = 0
    :: else
    fi
  :: mode == WALK ->
    chance(happens)  // the operator is lost
    if
    :: stopping == 0 && happens && event == NO_EVENT -> begin_stop()
    :: else
    fi
    chance(happens)  // the robot is at rest
    if
    :: stopping != 0 && (happens || wait == 0) -> ends = STOPPED
    :: stopping != 0 && !happens && wait > 0 -> wait--
    :: else
    fi
#ifdef ARMS_BY_ITSELF
  :: mode == PASSIVE -> ends = REQUEST_ARM
#endif
#ifdef STANDS_UP_UNASKED
  :: mode == DAMPING -> ends = REQUEST_STAND
#endif
  :: else
  fi
  follow_table(mode, ends, next)
}

// SafetyGate::judge; `modes` has the modes in which the condition of this tick is judged.
inline judge() {
  judged = next
#ifndef RESET_IGNORES_POSTURE
  if
  :: resetting -> judged = STAND
  :: else
  fi
#endif
  // In every mode some condition is judged; which one matters to a reset only.
  modes = 0
  chance(found)
  if
  :: resetting && found -> any_condition(modes); found = JUDGED_IN(judged, modes)
  :: else
  fi
  found = found || cut_seen
  // not_standing
  if
  :: mode == STAND_UP && next == STAND_UP && !folding && motion == 0 ->
    if
    :: wait > 0 -> wait--
    :: else ->
#ifndef WAITS_FOR_STAND
      found = 1
#else
      skip
#endif
    fi
  :: else
  fi
  // A silent joint is a fault, so it returns in Fault. The joints' judge notices it with the drives
  // off; a reset is judged as Stand.
  returns = 0
  if
  :: mode == FAULT && !hanging -> chance(returns)
  :: else
  fi
  misplaced = misplaced || returns
#ifdef RESET_FORGETS_DOUBT
  unsure = unsure || (returns && !DRIVEN(judged))
#else
  unsure = unsure || returns
#endif
  if
  :: judged == DAMPING && gate_mode == PASSIVE && unsure && !hanging -> found = 1
  :: !(judged == DAMPING && gate_mode == PASSIVE && unsure && !hanging) && DRIVEN(judged) &&
     DRIVEN(gate_mode) -> unsure = 0
  :: else
  fi
#ifdef MEMORY_OF_A_JUDGEMENT
  gate_mode = judged
#else
  gate_mode = (found -> FAULT : judged)
#endif
  latched = latched || found
}

inline step() {
  before = mode
  starting = !entered
  if
  :: motion > 0 && !starting -> motion--
  :: else
  fi
  if
  :: mode == STAND_UP && !starting && folding && motion == 0 ->  // continue_stand_up
    folding = 0
    start_motion(0, MOTION)
  :: else
  fi
  was_folding = folding
  if
  :: mode == FAULT -> chance(before_disable)
  :: else
  fi
  damped = !DRIVES_ON

  event = NO_EVENT
  next = mode
  if
  :: starting -> skip
  :: !starting ->
    if
    :: true -> any_request(event); after_request()
    :: true
    fi
    if
    :: next == mode -> after_time()
    :: else
    fi
  fi

  resetting = (mode == FAULT && next != FAULT)
  judge()
  if
  :: found -> next_mode(next, FAULT_FOUND, next)
  :: !found && resetting ->  // SafetyGate::clear
    latched = 0
#ifndef MEMORY_OF_A_JUDGEMENT
    gate_mode = PASSIVE
#endif
  :: else
  fi
  if
  :: (starting || next != mode) && next == FAULT -> enter_fault()
  :: (starting || next != mode) && next != FAULT -> enter(next)
  :: else
  fi

  if
  :: mode == PASSIVE -> command = OFF
  :: mode == DAMPING -> command = BRAKES
  :: CARRIES(mode) -> command = STIFF
  :: mode == FAULT ->
    command = (DRIVES_ON -> BRAKES : OFF)
#ifndef COMES_BACK_ON
    if
    :: !DRIVES_ON -> fault_steps = FAULT_STEPS
    :: else
    fi
#endif
#ifndef DAMPS_FOR_EVER
    if
    :: fault_steps < FAULT_STEPS -> fault_steps++
    :: else
    fi
#endif
  fi

  // SafetyGate::pass
  nonsense = 0
  if
  :: command == STIFF -> chance(nonsense)  // the command is not finite
  :: else
  fi
  if
  :: command != OFF ->
    latched = latched || nonsense
#ifndef MEMORY_OF_A_JUDGEMENT
    gate_mode = (nonsense -> FAULT : gate_mode)
#endif
#ifdef LATCH_LEAKS
    command = (latched && !nonsense -> BRAKES : command)
#else
    command = (latched -> BRAKES : command)
#endif
  :: else
  fi
#ifndef OUTPUT_FAULT_STAYS_IN_MODE
  if
  :: latched && mode != FAULT -> enter_fault()
  :: else
  fi
#endif
}

#define HOLDS(promise, condition) promise = (condition); assert(promise)

inline keep_promises() {
  HOLDS(off_or_brakes, !latched || command != STIFF)
  HOLDS(latched_in_fault, latched == (mode == FAULT))
  if
  :: before == FAULT && mode != FAULT ->
    HOLDS(reset_when_off, event == REQUEST_RESET_FAULT && damped)
    HOLDS(reset_when_well, !JUDGED_IN(STAND, modes) && !JUDGED_IN(PASSIVE, modes) && !cut_seen)
  :: before == FAULT && mode == FAULT ->
    HOLDS(off_for_good, command == OFF || !went_off)
  :: else
  fi
  went_off = (mode == FAULT && (went_off || command == OFF))
  // Drives go on by arm in Passive, or where a robot in the simulator starts on its feet.
  if
  :: (before == PASSIVE && event == REQUEST_ARM) || (starting && before == WALK) -> arm_given = 1
  :: else
  fi
  HOLDS(armed, command == OFF || arm_given)
  if
  :: command == OFF -> arm_given = 0
  :: else
  fi
  HOLDS(let_down, !CARRIES(before) || starting || mode != PASSIVE)
  if
  :: before != STAND_UP && mode == STAND_UP ->
    HOLDS(moves_when_asked, before == DAMPING && event == REQUEST_STAND)
  :: before != WALK && mode == WALK ->
    HOLDS(moves_when_asked, before == STAND && event == REQUEST_WALK && !hanging && !was_folding)
  :: else
  fi
  HOLDS(calms, !CALMS(event) || !(mode == STAND_UP || (mode == WALK && stopping == 0) ||
                                  (mode == STAND && folding)))
  HOLDS(way_of_the_table, before == mode || starting || IS_EDGE(before, mode))
  HOLDS(zero_known, !misplaced || !DRIVEN(mode))
}

inline send(owner_is_control, what) {
  d_step {
    HOLDS(one_owner, owner_is_control || what == OFF)
    drives = what
  }
}

active proctype control() {
  byte before, event, ends, next, judged, modes, from
  bit starting, found, resetting, happens, returns, nonsense, damped, was_folding, cut_seen
  atomic {
    if
    :: hanging = 1
    :: hanging = 0
    :: mode = WALK
    fi
  }
  do
  :: true ->
#ifndef CUT_IGNORED
    cut_seen = cut  // read()
#endif
    atomic {
      step()
      keep_promises()
      before = 0; event = 0; ends = 0; next = 0; judged = 0; modes = 0; from = 0; starting = 0
      found = 0; resetting = 0; happens = 0; returns = 0; nonsense = 0; damped = 0; was_folding = 0
      cut_seen = 0
    }
    // write()
    if
#ifdef CUT_IGNORED
    :: command != OFF -> send(1, command)
#else
    :: command != OFF && !cut ->
      if
      :: !cut -> send(1, command)
      :: else
      fi
#ifndef CUT_SEEN_ONCE
      if
      :: cut -> send(1, OFF)
      :: else
      fi
#endif
#endif
    :: else -> send(1, OFF)
    fi
#ifndef CUT_IGNORED
    d_step { HOLDS(cut_is_last, !cut_sent || drives == OFF) }
#endif
  :: true ->  // the loop ends: shut_down()
    atomic {
      mode = PASSIVE
      command = OFF
    }
    send(1, OFF)
    break
  od
}

// The watchdog, or the handler of a crash: at any time, or never.
active proctype watchdog() {
  cut = 1
#ifdef WATCHDOG_BRAKES
  send(0, BRAKES)
#else
  send(0, OFF)
#endif
  cut_sent = 1
}
