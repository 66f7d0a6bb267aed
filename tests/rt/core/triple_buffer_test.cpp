// SPDX-License-Identifier: BSD-3-Clause
// What one thread sees, and two of different priority on one processor. At full speed from two
// processors: exchange_test.cpp.
#include "rt/core/triple_buffer.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

namespace sandrunner {
namespace {

TEST(TripleBufferTest, IsEmptyBeforeTheFirstWrite) {
  TripleBuffer<int> buffer;
  EXPECT_EQ(buffer.read(), 0);
  EXPECT_EQ(buffer.sequence(), 0u);
}

TEST(TripleBufferTest, ReadsTheNewestValueAndItsNumber) {
  TripleBuffer<int> buffer;
  int value = 0;
  std::uint64_t written = 0;
  for (const int writes : {1, 2, 3, 4, 7}) {
    for (int i = 0; i < writes; ++i, ++written) buffer.write(++value);
    EXPECT_EQ(buffer.read(), value);
    EXPECT_EQ(buffer.sequence(), written);
  }
}

TEST(TripleBufferTest, WhatWasReadStaysUntilTheNextRead) {
  TripleBuffer<int> buffer;
  buffer.write(1);
  const int& value = buffer.read();
  for (int i = 2; i <= 6; ++i) {
    buffer.write(i);
    EXPECT_EQ(value, 1);
    EXPECT_EQ(buffer.sequence(), 1u);
  }
  EXPECT_EQ(buffer.read(), 6);
  EXPECT_EQ(buffer.read(), 6);  // nothing new: the same again
  EXPECT_EQ(buffer.sequence(), 6u);
}

/// Puts the calling thread on a processor with SCHED_FIFO. False: not permitted.
bool become_realtime(int cpu, int priority) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  const sched_param parameters{.sched_priority = priority};
  return pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0 &&
         pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

// A reader that waited for the writer it has preempted would wait for ever.
TEST(TripleBufferTest, ReaderThatPreemptsTheWriterOnItsProcessorFinishes) {
  cpu_set_t allowed;
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  int cpu = CPU_SETSIZE - 1;
  while (!CPU_ISSET(cpu, &allowed)) --cpu;
  // Without wait-freedom the kernel ends the test, before that would hold the processor for long.
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_RTTIME, &before), 0);
  const rlimit guard{std::min<rlim_t>(3'000'000, before.rlim_max), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_RTTIME, &guard), 0);

  constexpr int kReads = 300;
  using LongPayload = std::array<std::uint64_t, 50>;
  const auto buffer = std::make_unique<TripleBuffer<LongPayload>>();
  std::atomic<bool> end{false}, permitted{true};
  int reads = 0, fresh = 0, torn = 0, backwards = 0;
  std::thread reader([&] {
    if (!become_realtime(cpu, 50)) {
      permitted = false;
      end = true;
      return;
    }
    for (std::uint64_t last = 0; reads < kReads; ++reads) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const LongPayload& payload = buffer->read();
      const std::uint64_t number = buffer->sequence();
      torn += std::count(payload.begin(), payload.end(), number) != 50;
      backwards += number < last;
      fresh += number > last;
      last = number;
    }
    end = true;
  });
  std::thread writer([&] {
    if (!become_realtime(cpu, 10)) return;
    LongPayload payload;
    for (std::uint64_t n = 1; !end; ++n) {
      payload.fill(n);
      buffer->write(payload);
    }
  });
  reader.join();
  writer.join();
  setrlimit(RLIMIT_RTTIME, &before);
  if (!permitted) GTEST_SKIP() << "SCHED_FIFO is not permitted";
  EXPECT_EQ(reads, kReads);
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
  EXPECT_GT(fresh, kReads / 2);  // the writer was at work in between
}

}  // namespace
}  // namespace sandrunner
