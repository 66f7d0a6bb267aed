// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/recording/tick_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace sandrunner {
namespace {

void add(TickQueue& queue, std::uint64_t from, std::uint64_t to) {
  TickRecord record;
  for (record.input.sensors.tick = from; record.input.sensors.tick < to;
       ++record.input.sensors.tick) {
    queue.add(record);
  }
}

TEST(TickQueueTest, GivesBatchesInOrderAndTheRestAtTheEnd) {
  TickQueue queue(4, 10, WhenFull::kDrop);
  add(queue, 0, 10);
  EXPECT_EQ(queue.take()->front().input.sensors.tick, 0u);
  EXPECT_EQ(queue.take()->front().input.sensors.tick, 4u);
  queue.finish();
  EXPECT_EQ(queue.take()->size(), 2u);
  EXPECT_FALSE(queue.take());
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(TickQueueTest, FullQueueDropsTheNewestAndCounts) {
  TickQueue queue(4, 2, WhenFull::kDrop);
  add(queue, 0, 18);  // two batches, two that are dropped, and a half one
  queue.take();
  add(queue, 18, 20);
  EXPECT_EQ(queue.dropped(), 8u);
  EXPECT_EQ(queue.take()->front().input.sensors.tick, 4u);
  EXPECT_EQ(queue.take()->front().input.sensors.tick, 16u);
}

TEST(TickQueueTest, FullQueueThatWaitsDropsNothing) {
  TickQueue queue(4, 2, WhenFull::kWait);
  std::thread giver([&] {
    add(queue, 0, 4000);
    queue.finish();
  });
  std::uint64_t next = 0;
  while (const auto batch = queue.take()) {
    for (const TickRecord& record : *batch) EXPECT_EQ(record.input.sensors.tick, next++);
  }
  giver.join();
  EXPECT_EQ(next, 4000u);
  EXPECT_EQ(queue.dropped(), 0u);
}

}  // namespace
}  // namespace sandrunner
