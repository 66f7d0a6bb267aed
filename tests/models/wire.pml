// SPDX-License-Identifier: BSD-3-Clause
// Who commands a Go2's motors (drivers/unitree): the controller writes commands to memory that it
// shares with the wire's process. The wire alone sends them, by the rules of CommandWatch
// (command_watch.h). The guard sends once the wire was killed. Whatever time and other programs may
// do is a free choice.
//
// mistake FOLLOWS_AGAIN: given_up
// mistake GUARD_HURRIES: one_sender
// mistake GUARD_HOLDS_ON: one_source
// mistake OFF_GOES_ON: off_stays_off
// mistake POWERED_IS_LATE: ends_soft
// mistake GUARD_SLEEPS: ends_soft
// mistake HEARS_NO_END: ends_soft
// mistake SHOUTS_BACK: falls_silent
#define OFF 0
#define BRAKES 1
#define STIFF 2
// CommandWatch::Stage
#define S_WAIT 0
#define S_FOLLOW 1
#define S_DAMP 2
#define S_FOREIGN 3
#define S_OFF 4
#define S_SILENT 5
#define DAMPED 2  // messages, of the damping

// WireMemory
byte command = OFF
bit written, cut, done, foreign, powered
// The processes
bit controller_gone
bit wire_killed, wire_left  // left: it ended as it should
byte motors = OFF         // the last message that they heard
byte stage = S_WAIT

bit one_sender = 1      // the guard sends nothing while the wire is there
bit one_source = 1      // the guard switches no stiffness on
bit given_up = 1        // a controller that was given up is not followed again
bit off_stays_off = 1   // motors that were off stay off without a controller

// A wire or a guard is left to do it: without a controller the motors end without stiffness.
// Without a controller the motors end without stiffness, and the wire falls silent, if the wire or
// the guard is left.
ltl ends_soft { [] (controller_gone -> <> [] (motors != STIFF)) }
ltl falls_silent { [] (controller_gone -> <> [] (stage == S_SILENT || wire_killed)) }

#define HOLDS(promise, condition) promise = (condition); assert(promise)

active proctype controller() {
  do
  :: d_step { command = OFF; written = 1 }
  :: d_step { command = BRAKES; written = 1 }
  :: d_step { command = STIFF; written = 1 }
  :: cut = 1
  :: done = 1; command = OFF; break   // shut_down(); the gate's last command may be another
  :: break                            // killed
  od
  controller_gone = 1
}

active proctype others() {
  if
  :: foreign = 1
  :: true
  fi
}

active proctype wire() {
  byte what, damped = 0
  bit power = 0, off_sent = 0, lost, late, gave_up = 0
  do
  :: stage == S_SILENT && (controller_gone || done) -> wire_left = 1; break
  :: true -> wire_killed = 1; break
  :: stage != S_SILENT ->
    atomic {
      lost = cut || (controller_gone && !done)
      late = 0
      if
      :: stage == S_FOLLOW -> late = 1  // the last command is too old
      :: true
      fi
#ifdef HEARS_NO_END
      lost = cut
      late = 0
#endif
      // CommandWatch::judge
      if
      :: stage == S_FOREIGN -> skip
      :: stage != S_FOREIGN && foreign ->
        stage = (stage == S_WAIT -> S_SILENT : S_FOREIGN)
        damped = 0
      :: stage == S_WAIT && !foreign && (lost || done) -> stage = S_SILENT
      :: stage == S_WAIT && !foreign && !lost && !done && written -> stage = S_FOLLOW
      :: else
      fi
      if
      :: stage == S_FOLLOW && done -> stage = S_OFF
      :: stage == S_FOLLOW && !done && (lost || late) -> stage = S_DAMP
#ifdef FOLLOWS_AGAIN
      :: stage == S_DAMP && !lost -> stage = S_FOLLOW
#endif
      :: else
      fi
      // CommandWatch::next
      what = OFF
      if
      :: stage == S_FOLLOW ->
        what = command
        power = (command != OFF)
        HOLDS(given_up, !gave_up)
      :: stage == S_FOREIGN ->
#ifdef SHOUTS_BACK
        what = BRAKES
#else
        if
        :: damped == 0 -> what = BRAKES; damped = 1
        :: else -> stage = S_SILENT; powered = 0
        fi
#endif
      :: stage == S_DAMP && power && damped < DAMPED -> what = BRAKES; damped++
#ifdef OFF_GOES_ON
      :: stage == S_DAMP && !power && damped < DAMPED -> what = BRAKES; damped++
#else
      :: stage == S_DAMP && !power -> stage = S_OFF
#endif
      :: stage == S_DAMP && power && damped == DAMPED -> stage = S_OFF
      :: stage == S_OFF && !off_sent -> off_sent = 1
      :: stage == S_OFF && off_sent -> stage = S_SILENT
      :: else
      fi
      gave_up = (stage > S_FOLLOW)
    }
    if
    :: stage == S_WAIT || stage == S_SILENT
    :: else ->
      HOLDS(off_stays_off, what == OFF || stage != S_DAMP || motors != OFF)
#ifndef POWERED_IS_LATE
      powered = powered || what != OFF
#endif
      if
      :: true
      :: true -> wire_killed = 1; break
      fi
      motors = what
      if
      :: true
      :: true -> wire_killed = 1; break
      fi
      powered = (what != OFF)
    fi
  od
}

active proctype guard() {
  byte damped = 0
#ifdef GUARD_HURRIES
  if
  :: true
  :: wire_killed || wire_left
  fi
#else
  wire_killed || wire_left  // waitpid()
#endif
  if
#ifndef GUARD_SLEEPS
  :: !wire_left && powered ->
    do
    :: damped < DAMPED ->
      damped++
      d_step {
        HOLDS(one_sender, wire_killed)
#ifdef GUARD_HOLDS_ON
        motors = command
#else
        motors = BRAKES
#endif
        HOLDS(one_source, motors != STIFF)
      }
    :: else -> break
    od
    motors = OFF
#endif
  :: else
  fi
}
