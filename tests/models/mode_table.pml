// SPDX-License-Identifier: BSD-3-Clause
// Made from kTransitions and kRequestTable (rt/core/mode_machine.h) and kFaultTable
// (rt/core/faults.h). ModeTableTest compares it with them and says how to renew it.

#define PASSIVE 0
#define DAMPING 1
#define STAND_UP 2
#define STAND 3
#define WALK 4
#define FAULT 5

#define REQUEST_DISARM 0
#define REQUEST_DAMP 1
#define REQUEST_STAND 2
#define REQUEST_WALK 3
#define REQUEST_RESET_FAULT 4
#define REQUEST_ARM 5
#define REQUEST_STOP 6
#define REQUEST_LIE 7
#define STOOD_UP 8
#define STOPPED 9
#define LOWERED 10
#define FAULT_FOUND 11
#define NO_EVENT 12

inline next_mode(from, event, to) {
  if
  :: from == PASSIVE && event == REQUEST_ARM -> to = DAMPING
  :: from == PASSIVE && event == FAULT_FOUND -> to = FAULT
  :: from == DAMPING && event == REQUEST_DISARM -> to = PASSIVE
  :: from == DAMPING && event == REQUEST_STAND -> to = STAND_UP
  :: from == DAMPING && event == FAULT_FOUND -> to = FAULT
  :: from == STAND_UP && event == REQUEST_DAMP -> to = DAMPING
  :: from == STAND_UP && event == REQUEST_STOP -> to = DAMPING
  :: from == STAND_UP && event == REQUEST_LIE -> to = STAND
  :: from == STAND_UP && event == STOOD_UP -> to = STAND
  :: from == STAND_UP && event == FAULT_FOUND -> to = FAULT
  :: from == STAND && event == REQUEST_DAMP -> to = DAMPING
  :: from == STAND && event == REQUEST_WALK -> to = WALK
  :: from == STAND && event == LOWERED -> to = DAMPING
  :: from == STAND && event == FAULT_FOUND -> to = FAULT
  :: from == WALK && event == REQUEST_DAMP -> to = DAMPING
  :: from == WALK && event == STOPPED -> to = STAND
  :: from == WALK && event == FAULT_FOUND -> to = FAULT
  :: from == FAULT && event == REQUEST_RESET_FAULT -> to = PASSIVE
  :: else -> to = from
  fi
}

#define IS_EDGE(from, to) (false \
  || ((from) == PASSIVE && (to) == DAMPING) \
  || ((from) == PASSIVE && (to) == FAULT) \
  || ((from) == DAMPING && (to) == PASSIVE) \
  || ((from) == DAMPING && (to) == STAND_UP) \
  || ((from) == DAMPING && (to) == FAULT) \
  || ((from) == STAND_UP && (to) == DAMPING) \
  || ((from) == STAND_UP && (to) == STAND) \
  || ((from) == STAND_UP && (to) == FAULT) \
  || ((from) == STAND && (to) == DAMPING) \
  || ((from) == STAND && (to) == WALK) \
  || ((from) == STAND && (to) == FAULT) \
  || ((from) == WALK && (to) == DAMPING) \
  || ((from) == WALK && (to) == STAND) \
  || ((from) == WALK && (to) == FAULT) \
  || ((from) == FAULT && (to) == PASSIVE))

inline any_request(event) {
  if
  :: event = REQUEST_ARM
  :: event = REQUEST_STAND
  :: event = REQUEST_WALK
  :: event = REQUEST_STOP
  :: event = REQUEST_LIE
  :: event = REQUEST_DAMP
  :: event = REQUEST_DISARM
  :: event = REQUEST_RESET_FAULT
  fi
}

#define CALMS(event) (false || (event) == REQUEST_STOP || (event) == REQUEST_DAMP)

// The modes in which a condition for a fault is judged, bit m for mode m.
inline any_condition(modes) {
  if
  :: modes = 63  // as non_finite_joint
  :: modes = 16  // as non_finite_action
  :: modes = 62  // as non_finite_output
  :: modes = 28  // as tilt
  :: modes = 30  // as encoder_frozen
  :: modes = 4  // as not_standing
  :: modes = 2  // as joint_misplaced
  fi
}
#define JUDGED_IN(mode, modes) (((modes) >> (mode)) & 1)
