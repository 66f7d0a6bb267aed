// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace sandrunner {

/// Threads that are created once and then given batches of tasks. Which thread runs which task is
/// not determined: results must be written by task, never by worker. In the workers denormal
/// numbers are zero, as the simulator, and Adam's moments for their speed, ask for.
class WorkerPool {
 public:
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(threads_.size()); }

  /// Calls function(task, worker) for every task in [0, tasks), worker in [0, threads()); returns
  /// when all are done. Rethrows the first exception of a task, after the tasks already begun. Not
  /// reentrant.
  void run(int tasks, const std::function<void(int task, int worker)>& function);

 private:
  void work(int worker);

  std::mutex mutex_;
  std::condition_variable work_available_;
  std::condition_variable work_done_;
  const std::function<void(int, int)>* function_ = nullptr;
  int tasks_ = 0;      // of the batch
  int next_task_ = 0;  // not yet taken
  int running_ = 0;    // taken and not finished
  bool stop_ = false;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

}  // namespace sandrunner
