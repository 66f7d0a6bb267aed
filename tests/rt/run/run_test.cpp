// SPDX-License-Identifier: BSD-3-Clause
// Whole runs in this process: standing, walking, falling, being interrupted; the same bits each
// time.
#include "rt/run/run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <tuple>

#include "rt/report/run_csv.h"
#include "rt/report/summary.h"
#include "tests/rt/loop/faulty_robot.h"
#include "tests/rt/support.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

constexpr RunPlan kShortWalk{.walk_s = 0.5, .start_walking = true};

/// Each robot that ships, on each ground.
class EveryPresetTest : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(EveryPresetTest, RobotStandsUpStaysAndIsLetDown) {
  const auto& [robot, preset] = GetParam();
  const ProcessConfig config = config_of(preset, {"robot=" + robot});
  const RunResult result = run_once(config, {}, {});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_EQ(result.walked_s, 0.0);
  EXPECT_EQ(result.figures.joint_limit_steps, 0);
  const RunRow& first = result.record.rows.front();
  const RunRow& end = result.record.rows.back();
  const RunRow last = last_standing(result.record);
  EXPECT_LT(first.position_m[2], 0.15);
  // It rests on folded legs or lies, before its drives go off.
  EXPECT_EQ(mode_of(end), Mode::kDamping);
  EXPECT_LT(end.position_m[2], 0.22);
  EXPECT_LT(std::fabs(end.position_m[2] - result.record.rows.end()[-11].position_m[2]), 0.005);
  // The base as high over the feet as in the nominal pose, level and at rest. It leans where feet
  // sink in by centimetres.
  const bool deep =
      preset == "air-mattress" || preset == "memory-foam" || preset == "mud" || preset == "swamp";
  const double over_feet_m = config.robot.nominal_height_m - config.robot.model.foot_radius_m;
  for (int leg = 0; leg < kNumLegs; ++leg) {
    EXPECT_NEAR(last.position_m[2] - last.foot_m[leg][2], over_feet_m, deep ? 0.06 : 0.02);
  }
  const auto& [w, x, y, z] = last.orientation_wxyz;
  EXPECT_GT(1.0f - 2.0f * (x * x + y * y), deep ? 0.99f : 0.995f);
  EXPECT_LT(std::hypot(last.motion[0], last.motion[1]), 0.08);  // it still sways
}

INSTANTIATE_TEST_SUITE_P(Terrain, EveryPresetTest,
                         testing::Combine(testing::Values("raibo", "go2"),
                                          testing::ValuesIn(sim::terrain_preset_names())),
                         [](const auto& param_info) {
                           std::string name = std::get<0>(param_info.param);
                           name += "_" + std::get<1>(param_info.param);
                           std::erase(name, '-');
                           return name;
                         });

TEST(RunTest, StandsUpWithNoisyAndLateSensors) {
  const std::vector<std::string> noisy = {"sim.sensor_delay_ticks=4",
                                          "sim.actuator_delay_ticks=2",
                                          "sim.noise.joint_position_rad=0.002",
                                          "sim.noise.joint_velocity_radps=0.1",
                                          "sim.noise.orientation_rad=0.005",
                                          "sim.noise.angular_velocity_radps=0.05",
                                          "sim.noise.linear_acceleration_mps2=0.2"};
  const RunResult result = run_once(config_of("rigid", noisy), {}, {});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_NE(result.end.state_hash, run_once(config_of("rigid"), {}, {}).end.state_hash);
  EXPECT_EQ(result.end.state_hash, run_once(config_of("rigid", noisy), {}, {}).end.state_hash);
}

TEST(RunTest, SeedsGiveDifferentRuns) {
  ProcessConfig config = config_of("rigid");
  PolicyRunner policy(random_policy());
  std::uint64_t last = 0;
  for (config.simulator.seed = 0; config.simulator.seed < 4; ++config.simulator.seed) {
    const std::uint64_t hash = run_once(config, policy, kShortWalk).end.state_hash;
    EXPECT_NE(hash, last);
    EXPECT_EQ(hash, run_once(config, policy, kShortWalk).end.state_hash);
    last = hash;
  }
  PolicyRunner other(random_policy(2));
  config.simulator.seed = 0;
  EXPECT_NE(run_once(config, other, kShortWalk).end.state_hash,
            run_once(config, policy, kShortWalk).end.state_hash);
}

TEST(RunTest, WalkLastsAsLongAsAsked) {
  PolicyRunner policy(random_policy());
  const RunResult result = run_once(config_of("rigid", {}, policy.spec()), policy,
                                    {.walk_s = 0.25, .start_walking = true});
  EXPECT_EQ(result.walked_s, 0.25);
  EXPECT_EQ(result.end.time_s, 0.25);
  ASSERT_EQ(result.record.rows.size(), 25u);
  for (std::size_t i = 0; i < 25; ++i) {
    const RunRow& row = result.record.rows[i];
    EXPECT_DOUBLE_EQ(row.t_s, 0.01 * static_cast<double>(i));
    EXPECT_EQ(mode_of(row), Mode::kWalk);
    EXPECT_NE(row.flags & kRowHasEstimate, 0u);
    if (i > 0) {  // after the slew
      EXPECT_EQ(row.given[0], 1.0f);
    }
  }
}

TEST(RunTest, FallIsReportedWithReasonAndTime) {
  // Legs without stiffness give way at the knees; legs that fold lower the robot onto its belly.
  PolicySpec limp = random_policy_file().spec, folding = limp;
  limp.kp_nmprad = 0.0;
  folding.kp_nmprad = 15.0;
  folding.kd_nmsprad = 4.0;
  folding.action_scale_rad.fill(0.01);
  for (int leg = 0; leg < kNumLegs; ++leg) {
    folding.nominal_position_rad[3 * leg + 1] = 2.5;
    folding.nominal_position_rad[3 * leg + 2] = -2.4;
  }
  for (const PolicySpec& spec : {limp, folding}) {
    PolicyRunner policy(Policy(spec, Network(random_policy_file().parameters)));
    const RunResult result =
        run_once(config_of("rigid", {}, &spec), policy, {.walk_s = 5.0, .start_walking = true});
    EXPECT_FALSE(result.survived);
    EXPECT_EQ(result.fall_reason, spec.kp_nmprad > 0.0 ? "base_contact" : "thigh_contact");
    ASSERT_TRUE(result.fall_time_s.has_value());
    EXPECT_GT(*result.fall_time_s, 0.1);
    EXPECT_LT(*result.fall_time_s, 1.0);
    EXPECT_FALSE(result.interrupted);
    // It ends in a second of damping.
    EXPECT_NEAR(result.end.time_s, *result.fall_time_s + 1.0, 0.001);
    EXPECT_EQ(mode_of(result.record.rows.back()), Mode::kDamping);
  }
}

struct FaultRun {
  const char* reason;
  std::vector<std::string> assignments;
  double earliest_s, latest_s;
};

// Thresholds so low that ordinary motion crosses them.
TEST(RunTest, FaultIsReportedWithItsName) {
  const FaultRun runs[] = {
      {"joint_position",
       {"controller.walk.kp_nmprad=0", "controller.gate.joint_fault_rad=0"},
       0.05,
       2.0},
      {"joint_speed",
       {"controller.walk.kp_nmprad=0", "controller.gate.speed_fault_radps=2"},
       0.01,
       1.0},
      {"tilt", {"controller.gate.tilt_fault_deg=4"}, 0.01, 1.0},
      {"policy_stale",
       {"policy.latency_ticks=39", "controller.gate.policy_fault_ticks=60"},
       0.015,
       0.016},
  };
  for (const FaultRun& run : runs) {
    PolicyRunner policy(random_policy());
    ProcessConfig config = config_of("rigid", run.assignments, policy.spec());
    const RunResult result = run_once(config, policy, {.walk_s = 3.0, .start_walking = true});
    EXPECT_FALSE(result.survived) << run.reason;
    EXPECT_EQ(result.fall_reason, run.reason) << " at " << result.fall_time_s.value_or(-1);
    EXPECT_GE(result.fall_time_s.value_or(-1), run.earliest_s) << run.reason;
    EXPECT_LE(result.fall_time_s.value_or(99), run.latest_s) << run.reason;
    EXPECT_EQ(mode_of(result.record.rows.back()), Mode::kFault) << run.reason;
  }
}

TEST(RunTest, AnInfiniteWeightIsAFault) {
  PolicyFile file = random_policy_file();
  file.parameters.actor[2].bias[3] = std::numeric_limits<float>::infinity();
  PolicyRunner policy(Policy(file.spec, Network(file.parameters)));
  const RunResult result = run_once(config_of("rigid", {}, policy.spec()), policy,
                                    {.walk_s = 1.0, .start_walking = true});
  EXPECT_EQ(result.fall_reason, "non_finite_action");
}

TEST(RunTest, InterruptLiesDownAndIsNoFall) {
  // Folding on the ground, standing up, standing and walking.
  struct Case {
    double when_s, earliest_s, latest_s;
  };
  for (const auto& [when_s, earliest_s, latest_s] :
       {Case{0.5, 1.0, 1.0}, {2.0, 2.5, 2.5}, {3.0, 2.5, 2.5}, {4.5, 2.7, 6.0}}) {
    std::atomic<int> interrupt{false};
    PolicyRunner policy(random_policy());
    const ProcessConfig config =
        config_of("rigid", {"controller.walk.kp_nmprad=100"}, policy.spec());
    const RunResult result = simulate({.config = config,
                                       .policy = policy,
                                       .command = "0,0,0",
                                       .plan = {.walk_s = 100.0},
                                       .interrupts = &interrupt,
                                       .at_row = [&, at_s = when_s](const RunRow& row) {
                                         interrupt = interrupt || row.t_s >= at_s;
                                       }});
    EXPECT_TRUE(result.interrupted);
    EXPECT_TRUE(result.survived) << "interrupted after " << when_s << " s: " << result.fall_reason;
    EXPECT_GE(result.end.time_s, when_s + earliest_s - 0.001);
    EXPECT_LE(result.end.time_s, when_s + latest_s + 0.011);  // a row comes a period later
    EXPECT_EQ(mode_of(result.record.rows.back()), Mode::kDamping);
  }
}

TEST(RunTest, FiguresThatNeedTheTruthAreAbsentWithoutIt) {
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  const CommandSource command("1,0,0");
  sim::Simulator simulator(config.robot, config.simulator);
  FaultyRobot robot(simulator, Drives::kGains);
  robot.has_truth = false;
  RunScript script(command, {.walk_s = 1.0, .start_walking = true}, true);
  RunResult result = run_in_lockstep({.robot = robot,
                                      .controller = config.controller,
                                      .start = Mode::kWalk,
                                      .policy = policy,
                                      .op = script},
                                     {.scene = scene_of(config, "raibo")});
  script.report(result);
  const RunResult known = simulate(
      {.config = config, .policy = policy, .plan = {.walk_s = 1.0, .start_walking = true}});
  EXPECT_TRUE(result.survived);
  // Nor is it known whether it fell.
  EXPECT_NE(summary_json(result, {}).find("\"survived\": null"), std::string::npos);
  EXPECT_NE(summary_table(result, {}).find("whether it fell is not known"), std::string::npos);
  RunResult faulted = result;
  faulted.survived = false;
  faulted.fall_reason = "tilt";
  EXPECT_NE(summary_json(faulted, {}).find("\"survived\": false"), std::string::npos);
  EXPECT_NE(summary_json(known, {}).find("\"survived\": true"), std::string::npos);
  EXPECT_FALSE(result.figures.motion);
  EXPECT_FALSE(result.figures.estimate);
  EXPECT_FALSE(result.record.has_truth());
  EXPECT_TRUE(known.figures.motion);
  EXPECT_TRUE(known.figures.estimate);
  // The drives report the torque of the tick before.
  EXPECT_NEAR(result.figures.torque_squared_nm2, known.figures.torque_squared_nm2,
              0.01 * known.figures.torque_squared_nm2);
  const RunInfo info{"1,0,0", "raibo", "dry-sand", "lockstep", 0};
  EXPECT_EQ(summary_json(result, info).find("sinkage"), std::string::npos);
  EXPECT_EQ(summary_table(result, info).find("sinkage"), std::string::npos);
  EXPECT_NE(summary_table(known, info).find("sinkage"), std::string::npos);
  const TemporaryFolder folder;
  write_csv(result.record, folder.path("run.csv"));
}

class PublishedNetworkTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string weights = SANDRUNNER_SHARED_DIR "/reference-policy/reference.safetensors";
    if (!std::filesystem::exists(weights)) GTEST_SKIP() << "no reference policy at " << weights;
    const TemporaryFolder folder;
    const std::string path = folder.path("policy");
    const Ended import = run_process({SANDRUNNER_POLICY_PROGRAM, "import", weights, "--out", path});
    ASSERT_EQ(import.code, 0) << import.err;
    PolicyFile file = read_policy_file(path);  // it says nothing of its envelope
    file.spec.envelope = {.forward_mps = 4.0, .acceleration_mps2 = 100.0};
    policy_ = PolicyRunner(Policy(file.spec, Network(file.parameters)));
  }
  RunResult run(const std::string& terrain, const std::string& command, const RunPlan& plan,
                std::uint64_t seed = 0) {
    ProcessConfig config = config_of(terrain, {}, policy_.spec());
    config.simulator.seed = seed;
    return simulate({.config = config, .policy = policy_, .command = command, .plan = plan});
  }
  PolicyRunner policy_;
};

// The figures' origin: tests/golden/README.md.
TEST_F(PublishedNetworkTest, WalksOnRigidGround) {
  const RunResult result = run("rigid", "1,0,0", {.walk_s = 4.0, .start_walking = true});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_NEAR(result.figures.motion->mean_velocity_mps[0], 0.974, 0.05 * 0.974);
}

TEST_F(PublishedNetworkTest, RunsOnDrySand) {
  const RunResult result = run("dry-sand", "2,0,0", {.walk_s = 10.0, .start_walking = true});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_NEAR(result.figures.motion->mean_velocity_mps[0], 1.481, 0.05 * 1.481);
  EXPECT_NEAR(1e3 * result.figures.motion->sinkage_mean_m, 99.6, 0.1 * 99.6);
}

// At zero command this network trots on the spot, so that Stand takes over with two feet in the
// air.
TEST_F(PublishedNetworkTest, StandsAgainAfterTheWalk) {
  for (const std::uint64_t seed : {0u, 7u, 11u, 15u}) {
    const RunResult result = run("rigid", "1.5,0,0", {.walk_s = 6.0}, seed);
    EXPECT_TRUE(result.survived) << result.fall_reason << " with seed " << seed;
    EXPECT_EQ(result.walked_s, 6.0);
  }
}

}  // namespace
}  // namespace sandrunner
