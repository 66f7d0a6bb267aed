// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/slot_grid.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

constexpr std::int64_t kStart_ns = 1'000'000'007, kPeriod_ns = 250'000;

void expect_slot(const SlotGrid::Slot& slot, std::uint64_t number, std::uint64_t skipped,
                 std::int64_t late_ns) {
  EXPECT_EQ(slot.number, number);
  EXPECT_EQ(slot.skipped, skipped);
  EXPECT_EQ(slot.late_ns, late_ns);
}

TEST(SlotGridTest, SlotsFollowEachOtherOnTheGrid) {
  SlotGrid grid(kStart_ns, kPeriod_ns);
  for (std::uint64_t n = 0; n < 100; ++n) {
    EXPECT_EQ(grid.due_ns(), kStart_ns + static_cast<std::int64_t>(n) * kPeriod_ns);
    expect_slot(grid.take(grid.due_ns()), n, 0, 0);
  }
}

TEST(SlotGridTest, LateByLessThanAPeriodRunsAtOnceAndKeepsTheGrid) {
  SlotGrid grid(kStart_ns, kPeriod_ns);
  expect_slot(grid.take(kStart_ns + kPeriod_ns - 1), 0, 0, kPeriod_ns - 1);
  EXPECT_EQ(grid.due_ns(), kStart_ns + kPeriod_ns);  // 1 ns later: not shifted by the lateness
  expect_slot(grid.take(kStart_ns + kPeriod_ns), 1, 0, 0);
}

TEST(SlotGridTest, LaterSkipsWholeSlotsAndCountsThem) {
  SlotGrid grid(kStart_ns, kPeriod_ns);
  grid.take(kStart_ns);
  // Slot 1 is due one period after the start; a whole period late it is slot 2's time.
  expect_slot(grid.take(kStart_ns + 2 * kPeriod_ns), 2, 1, 0);
  expect_slot(grid.take(kStart_ns + 3 * kPeriod_ns + 5), 3, 0, 5);
  expect_slot(grid.take(kStart_ns + 9 * kPeriod_ns + kPeriod_ns / 2), 9, 5, kPeriod_ns / 2);
  EXPECT_EQ(grid.due_ns(), kStart_ns + 10 * kPeriod_ns);  // no burst: the next is the next
}

TEST(SlotGridTest, BeforeItIsDueASlotIsNotLate) {
  SlotGrid grid(kStart_ns, kPeriod_ns);
  expect_slot(grid.take(kStart_ns - 3 * kPeriod_ns), 0, 0, 0);
  EXPECT_EQ(grid.due_ns(), kStart_ns + kPeriod_ns);
}

TEST(SlotGridTest, RunAndSkippedSlotsAreAllSlots) {
  SlotGrid grid(kStart_ns, kPeriod_ns);
  std::uint64_t run = 0, skipped = 0, random = 1;
  SlotGrid::Slot slot;
  for (int i = 0; i < 100000; ++i) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    const std::int64_t now = grid.due_ns() + static_cast<std::int64_t>(random >> 44);  // < 1.05 ms
    slot = grid.take(now);
    ++run;
    skipped += slot.skipped;
    ASSERT_LT(slot.late_ns, kPeriod_ns);
    ASSERT_EQ(kStart_ns + static_cast<std::int64_t>(slot.number) * kPeriod_ns + slot.late_ns, now);
  }
  EXPECT_EQ(run + skipped, slot.number + 1);
  EXPECT_GT(skipped, 100000u);
}

TEST(SlotGridTest, DoesNotDriftInADay) {
  SlotGrid grid(kStart_ns, kPeriod_ns);
  constexpr std::int64_t kDay_slots = 86400LL * 4000;
  expect_slot(grid.take(kStart_ns + kDay_slots * kPeriod_ns + 1), kDay_slots, kDay_slots, 1);
  EXPECT_EQ(grid.due_ns(), kStart_ns + (kDay_slots + 1) * kPeriod_ns);
}

}  // namespace
}  // namespace sandrunner
