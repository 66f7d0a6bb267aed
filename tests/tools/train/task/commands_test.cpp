// SPDX-License-Identifier: BSD-3-Clause
// How the commands of a training change.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "rt/core/processor.h"
#include "tools/train/task/robot_settings.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr int kEnvs = 64, kSteps = 60;

/// Changes of vx in one step that were larger than an acceleration of 2 m/s^2 allows, and all, of
/// robots that were not reset meanwhile, where a change comes every 0.2 s and comes as a ramp in
/// `ramp_share` of the cases.
struct Changes {
  int steep = 0, all = 0;
};
Changes changes_with(const std::string& ramp_share) {
  flush_denormals_to_zero();
  const sim::Robot robot = sim::load_raibo();
  ConfigTree tree;
  add_training_layers(tree, robot);
  tree.set("command.change_s=0.2");
  tree.set("command.ramp_share=" + ramp_share);
  tree.set("command.forward_ramp_share=" + ramp_share);
  const TaskConfig config = read_task_config(tree);
  Task task(config, robot, {kEnvs, kEnvs}, 1);
  learner::Rollout rollout({kEnvs, kSteps, Task::privileged_size()}, 1);
  task.observe(0, 0, rollout);
  Changes changes;
  for (int t = 0; t < kSteps; ++t) {
    task.step(0, t, rollout);
    for (int env = 0; env < kEnvs; ++env) {
      if (rollout.reset(t + 1, env) != 0) continue;
      const float change =
          std::fabs(rollout.observation(t + 1)(0, env) - rollout.observation(t)(0, env));
      if (change > 0.0f) ++changes.all;
      if (change > 0.0201f) ++changes.steep;  // vx is shown as it is
    }
  }
  return changes;
}

TEST(CommandsTest, ComeAtOnceOrAsRamps) {
  const Changes at_once = changes_with("0"), ramps = changes_with("1");
  EXPECT_GT(at_once.steep, 100);
  EXPECT_EQ(ramps.steep, 0);
  EXPECT_GT(ramps.all, 5 * at_once.all);
}

}  // namespace
}  // namespace sandrunner::train
