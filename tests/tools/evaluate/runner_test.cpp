// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rt/core/processor.h"
#include "support.h"
#include "tests/rt/support.h"

namespace sandrunner::evaluate {
namespace {

// Some of each kind of trial, so that packs mix grounds, disturbances, falls and lengths.
std::vector<Trial> mixed_trials(Study& study) {
  std::vector<Trial> trials;
  for (const Part& part : {study.straight(), study.turn(), study.robust(), study.grid()}) {
    for (std::size_t g = 0; g < part.groups.size(); g += 9) {
      Trial trial = part.groups[g].trials.back();
      trial.duration_s = 0.5 + 0.1 * static_cast<double>(g % 4);
      trial.longest_s = 1.0;
      trials.push_back(trial);
    }
  }
  return trials;
}

class RunnerTest : public testing::Test {
 protected:
  RunnerTest() : study_({.runs = 3, .grid_runs = 2, .seed = 7}, sim::load_raibo()) {}

  std::vector<std::vector<std::uint64_t>> run(const std::vector<Trial>& trials,
                                              const Policy& policy, int threads,
                                              sim::BatchWidth width) {
    std::vector<std::vector<std::uint64_t>> bits;
    for (const TrialFigures& f :
         run_trials(study_.robot(), study_.foot(), policy, trials, {threads, true, width})) {
      bits.push_back(bits_of(f));
    }
    return bits;
  }

  Study study_;
};

TEST_F(RunnerTest, SameBitsForAnyThreadsAndWidth) {
  const std::vector<Trial> trials = mixed_trials(study_);
  const Policy policy = standing_policy();
  const auto expected = run(trials, policy, 1, sim::BatchWidth::kEight);
  EXPECT_NE(expected[0], expected[1]);
  EXPECT_EQ(run(trials, policy, 3, sim::BatchWidth::kEight), expected);
  EXPECT_EQ(run(trials, policy, 2, sim::BatchWidth::kOne), expected);
  if (sim::best_batch_width() == sim::BatchWidth::kSixteen) {
    EXPECT_EQ(run(trials, policy, 2, sim::BatchWidth::kSixteen), expected);
  }
}

TEST_F(RunnerTest, FiguresDoNotDependOnTheOtherRobotsOfThePack) {
  const std::vector<Trial> trials = mixed_trials(study_);
  const Policy policy = standing_policy();
  const auto all = run(trials, policy, 1, sim::BatchWidth::kEight);
  const auto one = run({trials[5]}, policy, 1, sim::BatchWidth::kEight);
  EXPECT_EQ(one[0], all[5]);
}

TEST_F(RunnerTest, DisturbancesActAndFollowTheSeed) {
  Trial trial;
  trial.terrain = study_.add(sim::terrain_preset("rigid"));
  trial.start = &study_.start(0);
  trial.duration_s = 1.5;
  trial.seed = 3;
  std::vector<Trial> trials(10, trial);
  trials[1].noise_scale = 3.0;
  trials[2].push_speed_mps = 0.6;
  trials[3].push_speed_mps = 0.6;
  trials[3].seed = 4;
  trials[4].latency_ticks = 40;
  trials[5].push_speed_mps = 0.6;
  trials[6].latency_ticks = 80;
  trials[7].sensors.imu_pitch_rad = 0.035f;
  trials[8].sensors.imu_roll_rad = 0.035f;
  trials[9].sensors.joint_offset_rad.fill(0.02f);
  const auto bits = run(trials, standing_policy(), 1, sim::BatchWidth::kEight);
  for (const int i : {1, 2, 3, 4, 6, 7, 8, 9}) EXPECT_NE(bits[i], bits[0]) << i;
  EXPECT_NE(bits[3], bits[2]);
  EXPECT_NE(bits[6], bits[4]);
  EXPECT_NE(bits[8], bits[7]);
  EXPECT_EQ(bits[5], bits[2]);
}

TEST_F(RunnerTest, AnObserverSeesEveryStepOfEachTrial) {
  Trial trial;
  trial.terrain = study_.add(sim::terrain_preset("dry-sand"));
  trial.duration_s = 0.5;
  std::vector<Trial> trials(11, trial);
  for (std::size_t i = 0; i < trials.size(); ++i)
    trials[i].start = &study_.start(static_cast<int>(i % 3));
  std::vector<int> steps(trials.size());
  std::vector<float> first_q(trials.size()), greatest_torque_nm(trials.size());
  const auto figures = run_trials(
      study_.robot(), study_.foot(), standing_policy(), trials, {2, true, sim::BatchWidth::kEight},
      {}, [&](std::size_t i, const ObservedStep& step) {
        if (steps[i]++ == 0) first_q[i] = step.state.rigid.q[2];
        for (const double torque : step.torque_nm) {
          greatest_torque_nm[i] =
              std::max(greatest_torque_nm[i], static_cast<float>(std::fabs(torque)));
        }
      });
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(steps[i], static_cast<int>(std::lround(100.0 * figures[i].time_s))) << i;
    EXPECT_EQ(first_q[i], trials[i].start->rigid.q[2]) << i;
    // What holds a quarter of the robot at its knee, and no more than the drive has.
    EXPECT_GT(greatest_torque_nm[i], 3.0f) << i;
    EXPECT_LE(greatest_torque_nm[i], 61.0f) << i;
  }
}

TEST_F(RunnerTest, LooseStepSinksIn) {
  // The second patch is out of reach; only LooseStep puts a foot on it.
  sim::TerrainDescription ground = sim::terrain_preset("dry-sand");
  sim::TerrainPatch soft{1e9, ground.patches[0].ground};
  soft.ground.sigma_flat_npm3 /= 4.0;
  soft.ground.sigma_cone_npm3 /= 4.0;
  ground.patches.push_back(soft);
  // Dropped, so that the feet touch down once after the start of the run.
  sim::RobotState<float> start = study_.start(0);
  start.rigid.position.z += 0.02f;
  start.rigid.velocity.x = 0.5f;
  Trial trial;
  trial.terrain = study_.add(ground);
  trial.start = &start;
  trial.duration_s = 0.5;
  std::vector<Trial> trials(2, trial);
  trials[1].loose_step.from_m = 1e-6;
  const std::vector<TrialFigures> f =
      run_trials(study_.robot(), study_.foot(), standing_policy(), trials, {});
  EXPECT_GT(f[1].tilt_rms_rad, f[0].tilt_rms_rad + 0.02);
}

TEST_F(RunnerTest, ProgressRisesToTheNumberOfTrials) {
  const std::vector<Trial> trials = mixed_trials(study_);
  std::size_t last = 0;
  run_trials(study_.robot(), study_.foot(), standing_policy(), trials, {.threads = 2},
             [&](std::size_t done) {
               EXPECT_GT(done, last);
               last = done;
             });
  EXPECT_EQ(last, trials.size());
}

TEST_F(RunnerTest, FactsAreTheRobotsWithTheLowerOfTwoTorqueLimits) {
  PolicySpec spec;
  spec.torque_limit_nm = 40.0;
  const RobotFacts facts = robot_facts(study_.robot(), spec);
  EXPECT_NEAR(facts.mass_kg, 26.817, 1e-3);
  EXPECT_NEAR(facts.foot_diagonal_m, 0.7011, 1e-3);
  EXPECT_EQ(facts.torque_limit_nm[5], 40.0);
}

// The control process in double and the evaluation in float are two programs around the same steps.
class EachRobotTest : public testing::TestWithParam<std::string> {
 protected:
  Study study_{{.runs = 3, .grid_runs = 2, .seed = 7}, sim::load_robot(GetParam())};
  const Policy policy_ = load_shipped_policy(GetParam());

  Trial walk(const char* ground, double speed_mps) {
    Trial trial;
    trial.terrain = study_.add(sim::terrain_preset(ground));
    trial.start = &study_.start(0);
    trial.command = {{speed_mps, 0.0, 0.0}, 0.0, policy_.spec().envelope.acceleration_mps2};
    trial.duration_s = 5.0;
    return trial;
  }
};

TEST_P(EachRobotTest, AgreesWithTheControlProcess) {
  flush_denormals_to_zero();
  for (const char* ground : {"dry-sand", "rigid"}) {
    SCOPED_TRACE(ground);
    const ProcessConfig config = config_of(ground, {"robot=" + GetParam()}, &policy_.spec());
    const RunResult process = simulate({.config = config,
                                        .policy = PolicyRunner(policy_),
                                        .command = "1.5,0,0",
                                        .plan = {.walk_s = 5.0, .start_walking = true}});
    ASSERT_TRUE(process.survived);
    const sandrunner::RunFigures& p = process.figures;
    const MotionFigures& motion = p.motion.value();
    const EstimateErrors& estimate = p.estimate.value();

    const TrialFigures e =
        run_trials(study_.robot(), study_.foot(), policy_, {walk(ground, 1.5)},
                   {.torque_speed_line = study_.robot().obeys_torque_speed_line})[0];
    ASSERT_FALSE(e.fell);
    EXPECT_NEAR(e.vx_mps, motion.mean_velocity_mps[0], 0.02);
    EXPECT_NEAR(e.vy_mps, motion.mean_velocity_mps[1], 0.02);
    EXPECT_NEAR(e.yaw_rate_radps, motion.mean_yaw_rate_radps, 0.02);
    EXPECT_NEAR(e.power_w, p.mechanical_power_w, 0.04 * p.mechanical_power_w + 1.0);
    EXPECT_NEAR(e.torque_squared_nm2, p.torque_squared_nm2, 0.04 * p.torque_squared_nm2);
    EXPECT_NEAR(e.cot, *motion.cost_of_transport, 0.04 * *motion.cost_of_transport);
    EXPECT_NEAR(e.clearance_iqr_m, motion.foot_clearance_iqr_m, 0.003);
    EXPECT_NEAR(e.velocity_rmse_mps, estimate.velocity_rmse_mps, 0.01);
    EXPECT_NEAR(e.body_height_rmse_m, estimate.body_height_rmse_m, 0.001);
    EXPECT_NEAR(e.foot_height_rmse_m, estimate.foot_height_rmse_m, 0.002);
  }
}

TEST_P(EachRobotTest, WalksWithTheSameBitsInEveryWidth) {
  const std::vector<Trial> trials = {walk("dry-sand", 1.0), walk("rigid", 1.5),
                                     walk("dry-sand", 0.5)};
  const auto run = [&](sim::BatchWidth width) {
    std::vector<std::vector<std::uint64_t>> bits;
    for (const TrialFigures& f :
         run_trials(study_.robot(), study_.foot(), policy_, trials, {1, true, width})) {
      bits.push_back(bits_of(f));
    }
    return bits;
  };
  EXPECT_EQ(run(sim::BatchWidth::kEight), run(sim::BatchWidth::kOne));
}

INSTANTIATE_TEST_SUITE_P(Robot, EachRobotTest, testing::Values("raibo", "go2"),
                         [](const auto& param_info) { return param_info.param; });

}  // namespace
}  // namespace sandrunner::evaluate
