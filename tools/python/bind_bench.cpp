// SPDX-License-Identifier: BSD-3-Clause
// The loop of sandrunner-train without its learner, for bench.py.
#include <algorithm>
#include <chrono>

#include "tools/python/bind.h"
#include "tools/python/environments.h"

namespace sandrunner::python {
namespace {

/// Environments as those given at their start, stepped in C++ alone.
class TaskLoop {
 public:
  TaskLoop(const Environments& like, std::uint64_t seed)
      : envs_(like.envs()),
        block_envs_(like.block_envs()),
        window_(like.window_steps()),
        pool_(like.threads()),
        task_(like.config(), like.robot(), {envs_, block_envs_}, seed),
        rollout_({.envs = envs_, .steps = 1, .privileged = train::Task::privileged_size()}, 1) {}

  /// Seconds of this many steps, with these actions in each.
  double run(const py::object& actions, int steps) {
    const auto array = checked_array<float>("actions", actions, {envs_, kNumJoints});
    const float* const from = array.data();
    const py::gil_scoped_release release;
    const auto start = std::chrono::steady_clock::now();
    for (int s = 0; s < steps; ++s) {
      pool_.run(envs_ / block_envs_, [&](int block, int) {
        const int first = block * block_envs_;
        std::copy_n(from + first * kNumJoints, block_envs_ * kNumJoints,
                    rollout_.action(0).col(first).data());
        task_.step(block, 0, rollout_);
      });
      if (++steps_ % window_ == 0) task_.end_window(static_cast<double>(steps_) * envs_, 0.0);
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  int envs_, block_envs_, window_;
  WorkerPool pool_;
  train::Task task_;
  learner::Rollout rollout_;
  int steps_ = 0;
};

}  // namespace

void bind_bench(py::module_& module) {
  py::class_<TaskLoop>(module, "TaskLoop")
      .def(py::init<const Environments&, std::uint64_t>(), py::arg("like"), py::arg("seed"))
      .def("run", &TaskLoop::run, py::arg("actions"), py::arg("steps"));
}

}  // namespace sandrunner::python
