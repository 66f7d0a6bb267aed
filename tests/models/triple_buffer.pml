// SPDX-License-Identifier: BSD-3-Clause
// TripleBuffer (rt/core/triple_buffer.h): one step of a process is one access to memory that both
// sides share. A value is three words, so that a torn one shows.
//
// mistake READS_IN_PLACE: whole
// mistake PUBLISHES_EARLY: newest
// mistake ALWAYS_EXCHANGES: forward
// mistake NEVER_FRESH: newest
// mistake WRITER_WAITS: invalid end state
#ifndef WRITES
#define WRITES 6
#endif
#define INDEX 3
#define FRESH 4

typedef Slot { byte first, second, sequence }
Slot slots[3]
byte middle = 2

// What is promised of every read.
bit whole = 1    // its words belong to one write
bit forward = 1  // it is no older than the read before
bit newest = 1   // it is no older than the last write that was complete when the read began
byte published   // the last complete write

// A thread may stop for ever wherever it is: the other one must not need it.
inline may_stop() {
  if
  :: true
  :: true -> goto stopped
  fi
}

active proctype writer() {
  byte index = 0, old, sequence = 0
  do
  :: sequence < WRITES ->
    may_stop()
#ifdef WRITER_WAITS
    (middle & FRESH) == 0
#endif
    sequence++
#ifdef PUBLISHES_EARLY
    d_step { old = middle; middle = index | FRESH; published = sequence }
#endif
    slots[index].first = sequence
    may_stop()
    slots[index].second = sequence
    slots[index].sequence = sequence
    may_stop()
#ifdef NEVER_FRESH
    d_step { old = middle; middle = index; published = sequence }
#else
#ifndef PUBLISHES_EARLY
    d_step { old = middle; middle = index | FRESH; published = sequence }  // exchange
#endif
#endif
    index = old & INDEX
  :: else -> break
  od
stopped:
  skip
}

active proctype reader() {
  byte index = 1, old, first, second, last = 0, published_before
  do
  :: true -> break
  :: true ->
    published_before = published
    may_stop()
#ifdef ALWAYS_EXCHANGES
    d_step { old = middle; middle = index; index = old & INDEX }
#else
    if
    :: (middle & FRESH) != 0 ->  // load
      may_stop()
#ifdef READS_IN_PLACE
      index = middle & INDEX
#else
      d_step { old = middle; middle = index; index = old & INDEX }  // exchange
#endif
    :: else
    fi
#endif
    first = slots[index].first
    may_stop()
    second = slots[index].second
    d_step {
      whole = (first == second && first == slots[index].sequence)
      assert(whole)
      forward = (first >= last)
      assert(forward)
      newest = (first >= published_before)
      assert(newest)
      last = first
      first = 0
      second = 0
      old = 0
      published_before = 0
    }
  od
stopped:
  skip
}
