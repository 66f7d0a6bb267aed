// SPDX-License-Identifier: BSD-3-Clause
// SpscRing (rt/core/spsc_ring.h): one step of a process is one access to memory that both sides
// share. A record is two words, so that a torn one shows.
//
// size CAPACITY=1
// size CAPACITY=2
// size CAPACITY=4
// mistake PUBLISHES_EARLY: in_order
// mistake POPS_EARLY: whole
// mistake OVERWRITES: whole
// mistake FORGETS_POP: in_order
// mistake NO_COUNT: counted
// mistake NEVER_LOOKS_AGAIN: only_full
// mistake WRITER_WAITS: invalid end state
#ifndef CAPACITY
#define CAPACITY 2
#endif
#ifndef RECORDS
#define RECORDS 8
#endif

typedef Slot { byte first, second }
Slot slots[CAPACITY]
byte written, read, dropped
bool ended = false  // all records were pushed

// What is promised.
bit whole = 1      // the words of a record belong to one push
bit in_order = 1   // a record is newer than the one before: none twice
bit counted = 1    // at the end, every record was read or counted as dropped
bit only_full = 1  // a record is dropped only if the ring is full

// A thread may stop for ever wherever it is: the other one must not need it.
inline may_stop() {
  if
  :: true
  :: true -> goto stopped
  fi
}

active proctype writer() {
  byte record = 0, next, known_read = 0
  do
  :: record < RECORDS ->
    may_stop()
    record++
    next = written
    if
#ifndef OVERWRITES
    :: next - known_read == CAPACITY ->
#ifdef WRITER_WAITS
      next - read < CAPACITY
#endif
      d_step {
#ifndef NEVER_LOOKS_AGAIN
        known_read = read  // load
#endif
        only_full = (next - known_read < CAPACITY || next - read == CAPACITY)
        assert(only_full)
      }
      if
      :: next - known_read == CAPACITY ->
#ifndef NO_COUNT
        dropped++
#endif
        goto dropped_record
      :: else
      fi
#endif
    :: else
    fi
#ifdef PUBLISHES_EARLY
    written = next + 1
#endif
    slots[next % CAPACITY].first = record
    may_stop()
    slots[next % CAPACITY].second = record
    may_stop()
#ifndef PUBLISHES_EARLY
    written = next + 1  // store
#endif
dropped_record:
    skip
  :: else -> break
  od
  ended = true
stopped:
  skip
}

active proctype reader() {
  byte next, first, second, last = 0, taken = 0, missing = 0
  bool last_look
  do
  :: true ->
    may_stop()
    last_look = ended
    next = read
    if
    :: written == next ->  // load: empty
      if
      :: last_look -> break
      :: else
      fi
    :: else ->
#ifdef POPS_EARLY
      read = next + 1
#endif
      first = slots[next % CAPACITY].first
      may_stop()
      second = slots[next % CAPACITY].second
      d_step {
        whole = (first == second)
        assert(whole)
        in_order = (first > last)
        assert(in_order)
        missing = missing + first - last - 1
        taken++
        last = first
        first = 0
        second = 0
      }
      may_stop()
#ifndef POPS_EARLY
#ifdef FORGETS_POP
      if
      :: taken == 2 -> skip
      :: else -> read = next + 1
      fi
#else
      read = next + 1  // store
#endif
#endif
    fi
  od
  counted = (taken + dropped == RECORDS && missing + RECORDS - last == dropped)
  assert(counted)
stopped:
  skip
}
