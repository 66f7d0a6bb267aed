// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/worker_pool.h"

#include <utility>

#include "rt/core/processor.h"

namespace sandrunner {

WorkerPool::WorkerPool(int threads) {
  for (int worker = 0; worker < threads; ++worker) {
    threads_.emplace_back([this, worker] { work(worker); });
  }
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  work_available_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::run(int tasks, const std::function<void(int, int)>& function) {
  std::unique_lock lock(mutex_);
  function_ = &function;
  tasks_ = tasks;
  next_task_ = 0;
  work_available_.notify_all();
  work_done_.wait(lock, [this] { return next_task_ >= tasks_ && running_ == 0; });
  function_ = nullptr;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void WorkerPool::work(int worker) {
  flush_denormals_to_zero();
  std::unique_lock lock(mutex_);
  while (true) {
    work_available_.wait(lock, [this] { return stop_ || next_task_ < tasks_; });
    if (stop_) return;
    const int task = next_task_++;
    ++running_;
    lock.unlock();
    std::exception_ptr error;
    try {
      (*function_)(task, worker);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    --running_;
    if (error) {
      if (!error_) error_ = error;
      next_task_ = tasks_;
    }
    if (next_task_ >= tasks_ && running_ == 0) work_done_.notify_one();
  }
}

}  // namespace sandrunner
