// SPDX-License-Identifier: BSD-3-Clause
// rollout_reference OUT ENVS STEPS SEED [PATH=VALUE...]: the rollout of sandrunner-train that goes
// on from the shipped policy, learning from window to window as Training::run does, for
// vector_env_test.py. Writes, in this order: the observations (ENVS, 33) of the start; for each
// step the actions (ENVS, 12) in leg modes, the observations, privileged observations and
// estimator's targets after it, the rewards, and the ends and resets as bytes; the curriculum's
// speed (double).
#include <cstdlib>
#include <fstream>
#include <string>

#include "policy/policy_file.h"
#include "rt/base/config_tree.h"
#include "rt/base/worker_pool.h"
#include "sim/robot/robot_model.h"
#include "tools/train/learner/learner.h"
#include "tools/train/policy_spec.h"
#include "tools/train/task/leg_modes.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"
#include "tools/train/train_config.h"

namespace sandrunner::train {
namespace {

void set_shipped_policy(const TaskConfig& config, learner::Learner& learner) {
  PolicyFile policy = parse_policy_file(shipped_policy_text(), "raibo");
  answer_in_modes(config.policy.mode_gain, policy.parameters);
  learner.set_policy(policy.parameters);
}

class Writer {
 public:
  explicit Writer(const char* path) : out_(path, std::ios::binary) {}
  template <typename T>
  void add(const T* values, std::ptrdiff_t count) {
    out_.write(reinterpret_cast<const char*>(values), count * std::ptrdiff_t{sizeof(T)});
  }
  template <typename Block>
  void add(const Block& block) {
    add(block.data(), block.size());
  }
  bool good() { return bool(out_.flush()); }

 private:
  std::ofstream out_;
};

bool run(const char* path, int envs, int steps, std::uint64_t seed,
         const std::vector<std::string>& settings) {
  const sim::Robot robot = sim::load_raibo();
  ConfigTree tree;
  add_training_layers(tree, robot);
  for (const std::string& setting : settings) tree.set(setting);
  tree.set("run.envs=" + std::to_string(envs));
  const TrainConfig config = read_train_config(tree);
  WorkerPool pool(2);
  Task task(config.task, robot, {envs, config.learner.block_envs}, seed);
  learner::Learner learner(config.learner, {envs, config.window, Task::privileged_size()}, seed,
                           pool, Task::symmetry(robot));
  set_shipped_policy(config.task, learner);
  learner::Rollout& r = learner.rollout();
  pool.run(learner.blocks(), [&](int block, int) { task.observe(block, 0, r); });
  Writer out(path);
  out.add(r.observation(0));
  for (int done = 0; done < steps;) {
    pool.run(learner.blocks(), [&](int block, int worker) {
      for (int t = 0; t < config.window; ++t) {
        learner.act_block(block, t, worker);
        task.step(block, t, r);
      }
    });
    for (int t = 0; t < config.window && done < steps; ++t, ++done) {
      out.add(r.action(t));
      out.add(r.observation(t + 1));
      out.add(r.privileged(t + 1));
      out.add(r.estimate_target(t + 1));
      out.add(&r.reward(t, 0), envs);
      out.add(&r.end(t, 0), envs);
      out.add(&r.reset(t + 1, 0), envs);
    }
    learner.update();
    task.end_window(static_cast<double>(learner.transitions()), 0.0);
  }
  out.add(&task.curriculum().speed_mps, 1);
  return out.good();
}

}  // namespace
}  // namespace sandrunner::train

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const std::vector<std::string> settings(argv + 5, argv + argc);
  return sandrunner::train::run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]),
                                static_cast<std::uint64_t>(std::atoll(argv[4])), settings)
             ? 0
             : 1;
}
