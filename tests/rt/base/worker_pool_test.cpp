// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <vector>

namespace sandrunner {
namespace {

TEST(WorkerPoolTest, RunsEveryTaskOnceAndWaitsForAll) {
  WorkerPool pool(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<int> runs(
        7, 0);  // no lock: a task run twice or not awaited is a wrong count (or a race)
    pool.run(7, [&](int task, int worker) {
      ASSERT_TRUE(worker >= 0 && worker < 3);
      ++runs[static_cast<std::size_t>(task)];
    });
    EXPECT_EQ(runs, std::vector<int>(7, 1));
  }
}

TEST(WorkerPoolTest, HandsOnAnExceptionAndStaysUsable) {
  WorkerPool pool(2);
  EXPECT_THROW(pool.run(10,
                        [](int task, int) {
                          if (task == 3) throw std::runtime_error("task 3");
                        }),
               std::runtime_error);
  std::atomic<int> runs = 0;
  pool.run(10, [&](int, int) { ++runs; });
  EXPECT_EQ(runs, 10);
}

TEST(WorkerPoolTest, FlushesDenormalsInEveryWorker) {
  WorkerPool pool(2);
  std::vector<float> results(16, 1.0f);
  pool.run(16, [&](int task, int) {
    volatile float smallest = std::numeric_limits<float>::min();
    results[static_cast<std::size_t>(task)] = smallest * 0.5f;
  });
  EXPECT_EQ(results, std::vector<float>(16, 0.0f));
}

}  // namespace
}  // namespace sandrunner
