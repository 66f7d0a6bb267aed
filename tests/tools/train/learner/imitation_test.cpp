// SPDX-License-Identifier: BSD-3-Clause
// A student imitates a teacher on the toy task.
#include <gtest/gtest.h>

#include "rt/base/errors.h"
#include "tests/support/error_of.h"
#include "toy_task.h"

namespace sandrunner::learner {
namespace {

LearnerConfig toy_config() {
  LearnerConfig config;
  config.network = {16, {16}, {32, 32}, {32, 32}};
  config.network.wiring.actor_sees = {true, false, true, false};
  config.network.insight = {24};
  config.block_envs = 32;
  config.gamma = 0.95;
  config.learning_rate_max = 5e-3;
  config.loss.estimate_weight = 0.0;
  return config;
}

LearnerConfig teacher_config() {
  LearnerConfig config = toy_config();
  config.network.wiring.encoder = EncoderKind::kInsight;
  return config;
}

LearnerConfig student_config() {
  LearnerConfig config = toy_config();
  config.loss.policy_weight = 0.0;
  config.loss.imitation_weight = config.loss.encoding_weight = 1.0;
  config.action_std_start = config.action_std_min = 0.05;
  config.learning_rate_start = config.learning_rate_min = config.learning_rate_max = 2e-3;
  return config;
}

RolloutShape toy_shape(int teacher) {
  RolloutShape shape{256, 16, kToyPrivileged};
  shape.insight = kInsightSize;
  shape.teacher = teacher;
  return shape;
}

/// Mean reward of the last windows.
double train(Learner& learner, WorkerPool& pool, int windows) {
  ToyTask task(learner, pool);
  double reward = 0.0;
  for (int window = 0; window < windows; ++window) {
    const double now = task.run_window();
    EXPECT_TRUE(learner.update().finite);
    if (window >= windows - 4) reward += now / 4.0;
  }
  return reward;
}

TEST(ImitationTest, StudentComesCloseToATeacherThatSeesWhatIsHidden) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "takes half a minute when instrumented; LearnerTest runs the same code";
#endif
  WorkerPool pool(2);
  Learner teacher(teacher_config(), toy_shape(0), 1, pool);
  train(teacher, pool, 60);
  teacher.set_action_std_most(0.05);  // as little noise as the student has
  const double taught = train(teacher, pool, 12);

  Learner student(student_config(), toy_shape(16), 1, pool);
  student.set_teacher(teacher.layout(), teacher.parameters());
  const double first = train(student, pool, 4);
  const double imitated = train(student, pool, 100);
  EXPECT_LT(first, 0.8 * taught);
  EXPECT_GT(imitated, 0.95 * taught);
  // Seed 1: 0.196, 0.111, 0.196.
}

TEST(ImitationTest, AStudentThatIsItsTeacherHasNothingToLearn) {
  WorkerPool pool(1);
  Learner learner(student_config(), toy_shape(16), 1, pool);
  learner.set_teacher(learner.layout(), learner.parameters());
  ToyTask task(learner, pool);
  for (int window = 0; window < 3; ++window) {
    task.run_window();
    const UpdateStats stats = learner.update();
    EXPECT_EQ(stats.imitation_rms, 0.0);
    EXPECT_EQ(stats.encoding_rms, 0.0);
  }
}

TEST(ImitationTest, ATeacherOfAnotherSizeIsRefused) {
  WorkerPool pool(1);
  Learner learner(student_config(), toy_shape(16), 1, pool);
  NetworkSizes wider = toy_config().network;
  wider.actor = {40, 32};
  const ParameterLayout layout(wider, kToyPrivileged);
  EXPECT_EQ(error_of([&] { learner.set_teacher(layout, std::vector<float>(layout.size())); }),
            "teacher: found encoding and actor of sizes 16-49-40-32-12, expected 16-49-32-32-12");
}

TEST(ImitationTest, ResumesToTheSameWeightsWithTheSameTeacherOnly) {
  WorkerPool pool(1);
  const Learner teacher(teacher_config(), toy_shape(0), 1, pool);
  const Learner another(teacher_config(), toy_shape(0), 2, pool);
  Learner whole(student_config(), toy_shape(16), 1, pool);
  whole.set_teacher(teacher.layout(), teacher.parameters());
  ToyTask task(whole, pool);
  task.run_window();
  whole.update();
  Checkpoint checkpoint;
  whole.save(checkpoint);
  const auto states = task.states;
  task.run_window();
  whole.update();

  Learner resumed(student_config(), toy_shape(16), 7, pool);
  resumed.set_teacher(teacher.layout(), teacher.parameters());
  ToyTask rest(resumed, pool);
  rest.states = states;
  resumed.load(checkpoint);
  rest.run_window();
  resumed.update();
  EXPECT_EQ(resumed.parameters(), whole.parameters());

  resumed.set_teacher(another.layout(), another.parameters());
  EXPECT_THROW(resumed.load(checkpoint), InputError);
}

}  // namespace
}  // namespace sandrunner::learner
