// SPDX-License-Identifier: BSD-3-Clause
// Two threads at full speed on each of the lock-free primitives. Built twice: with few exchanges
// for everyday, with ten million for the thread sanitizer and the patient.
#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>

#include "rt/core/spsc_ring.h"
#include "rt/core/triple_buffer.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kExchanges = SANDRUNNER_EXCHANGES;

/// Attempts after which a thread lets the other one in, in case they have only one processor.
constexpr std::uint64_t kPatience = 256;

/// Longer than several cache lines: a value that is read while it is written shows.
using Payload = std::array<std::uint64_t, 50>;
constexpr std::uint64_t kTorn = ~std::uint64_t{0};

Payload payload_of(std::uint64_t value) {
  Payload payload;
  payload.fill(value);
  return payload;
}
std::uint64_t value_of(const Payload& payload) {
  const bool whole = std::all_of(payload.begin(), payload.end(),
                                 [&](std::uint64_t word) { return word == payload[0]; });
  return whole ? payload[0] : kTorn;
}

/// Keeps the calling thread on the first or the last processor that the process may use.
void stay_on(bool last) {
  cpu_set_t allowed, one;
  CPU_ZERO(&one);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
  int cpu = last ? CPU_SETSIZE - 1 : 0;
  while (!CPU_ISSET(cpu, &allowed)) cpu += last ? -1 : 1;
  CPU_SET(cpu, &one);
  sched_setaffinity(0, sizeof one, &one);
}

/// Calls `write` in one thread and `read` in another until all is written, and once more. On two
/// processors if there are two: left to itself, Linux likes to put both on one.
template <typename Write, typename Read>
void exchange(const Write& write, const Read& read) {
  std::atomic<bool> reads{false}, written{false};
  std::thread reader([&] {
    stay_on(true);
    reads = true;
    for (bool last = false; !last;) {
      last = written;
      read();
    }
  });
  std::thread writer([&] {
    stay_on(false);
    while (!reads) std::this_thread::yield();
    write();
    written = true;
  });
  writer.join();
  reader.join();
}

TEST(ExchangeTest, TripleBufferHandsOverWholeValuesNeverBackwards) {
  const auto buffer = std::make_unique<TripleBuffer<Payload>>();
  std::uint64_t last = 0, fresh = 0, stale = 0, torn = 0, backwards = 0, misnumbered = 0;
  exchange(
      [&] {
        for (std::uint64_t n = 1; n <= kExchanges; ++n) {
          buffer->write(payload_of(n));
          if (n % kPatience == 0) std::this_thread::yield();
        }
      },
      [&] {
        const std::uint64_t value = value_of(buffer->read());
        torn += value == kTorn;
        backwards += value < last;
        misnumbered += value != buffer->sequence();
        fresh += value != last;
        if (value == last && ++stale % kPatience == 0) std::this_thread::yield();
        last = value;
      });
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backwards, 0u);
  EXPECT_EQ(misnumbered, 0u);
  EXPECT_EQ(last, kExchanges);
  RecordProperty("values_seen", std::to_string(fresh));
}

TEST(ExchangeTest, SpscRingKeepsAllValuesInOrderIfTheWriterWaits) {
  const auto ring = std::make_unique<SpscRing<Payload, 256>>();
  std::uint64_t full = 0, empty = 0, read = 0, wrong = 0;
  exchange(
      [&] {
        for (std::uint64_t n = 1; n <= kExchanges; ++n) {
          Payload* place = ring->claim();
          for (; !place; place = ring->claim()) {
            if (++full % kPatience == 0) std::this_thread::yield();
          }
          place->fill(n);
          ring->publish();
        }
      },
      [&] {
        for (; const Payload* payload = ring->front(); ring->pop()) {
          wrong += value_of(*payload) != ++read;
        }
        if (++empty % kPatience == 0) std::this_thread::yield();
      });
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(read, kExchanges);
  EXPECT_EQ(ring->dropped(), full);
}

TEST(ExchangeTest, SpscRingCountsEveryDropIfTheWriterDoesNotWait) {
  const auto ring = std::make_unique<SpscRing<Payload, 256>>();
  std::uint64_t pushed = 0, read = 0, last = 0, missing = 0, wrong = 0;
  exchange(
      [&] {
        for (std::uint64_t n = 1; n <= kExchanges; ++n) pushed += ring->push(payload_of(n));
      },
      [&] {
        for (; const Payload* payload = ring->front(); ring->pop()) {
          const std::uint64_t value = value_of(*payload);
          if (value == kTorn || value <= last) {
            ++wrong;
            continue;
          }
          missing += value - last - 1;
          last = value;
          // Pauses in which the ring overflows.
          if (++read % 4096 == 0) std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
      });
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(read, pushed);
  EXPECT_EQ(read + ring->dropped(), kExchanges);
  EXPECT_EQ(missing + (kExchanges - last), ring->dropped());
  EXPECT_GT(read, 0u);
  EXPECT_GT(ring->dropped(), 0u);
}

}  // namespace
}  // namespace sandrunner
