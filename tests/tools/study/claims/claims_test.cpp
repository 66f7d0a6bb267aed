// SPDX-License-Identifier: BSD-3-Clause
// Verdicts on made-up measurements.
#include "tools/study/claims/claims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "tools/study/experiments/lab.h"
#include "tools/study/experiments/oracles.h"

namespace sandrunner::study {
namespace {

// A controller that succeeds in `successes` of `runs` runs at every command, and has this top
// speed.
struct MadeUp {
  int runs = 16;
  int successes = 16;
  double top_mps = 3.0;
  int alive_on_own_ground = 16;
};

Measured straight_runs(const MadeUp& m, const std::string& ground,
                       const std::vector<double>& commands, int alive) {
  Measured measured;
  for (const double command : commands) {
    RunGroup group{ground, "", command, {}, {}};
    for (int i = 0; i < m.runs; ++i) {
      const bool success = i < m.successes;
      group.runs["success"].push_back(success);
      group.runs["alive"].push_back(i < alive);
      group.runs["speed_mps"].push_back(command);
      group.runs["end_speed_mps"].push_back(m.top_mps + 0.001 * i);
      group.runs["cot"].push_back(0.5);
      group.runs["limit_alone"].push_back(0.0);
      group.runs["depth_m"].push_back(0.05);
    }
    measured.groups.push_back(group);
  }
  return measured;
}

void add(Evidence& evidence, const std::string& controller, int seed, const MadeUp& m) {
  evidence.measured["E1"][controller][seed] =
      straight_runs(m, "beach", straight_commands(), m.successes);
  evidence.measured["fairness"][controller][seed] =
      straight_runs(m, "own", {1.0, 2.0, 3.0}, m.alive_on_own_ground);
}

const Claim& claim(const std::string& id) {
  const auto found =
      std::find_if(claims().begin(), claims().end(), [&](const Claim& c) { return c.id == id; });
  if (found == claims().end()) throw std::logic_error("no claim " + id);
  return *found;
}

std::string verdict(const std::string& id, const Evidence& evidence) {
  return judgement_text(judge(claim(id), evidence));
}

TEST(ClaimsTest, ARuleThatHoldsAgrees) {
  Evidence evidence;
  for (const int seed : {1, 2}) add(evidence, "ours", seed, {.top_mps = 3.1});
  EXPECT_EQ(verdict("1", evidence), "agrees");
  EXPECT_EQ(verdict("8", evidence), "agrees");
}

TEST(ClaimsTest, TheOppositeContradicts) {
  Evidence evidence;
  for (const int seed : {1, 2}) add(evidence, "ours", seed, {.successes = 13, .top_mps = 1.0});
  EXPECT_EQ(verdict("1", evidence), "contradicts");
  EXPECT_EQ(verdict("8", evidence), "contradicts");
}

TEST(ClaimsTest, BetweenTheTwoNothingCanBeTold) {
  Evidence evidence;
  for (const int seed : {1, 2}) add(evidence, "ours", seed, {.successes = 15, .top_mps = 2.4});
  EXPECT_EQ(verdict("1", evidence), "can't tell");
  EXPECT_EQ(verdict("8", evidence), "can't tell");
}

TEST(ClaimsTest, WhatTheSimulationLacksIsNotTestable) {
  for (const char* id : {"5", "11", "30"}) {
    EXPECT_EQ(verdict(id, {}), "not testable in simulation") << id;
  }
}

TEST(ClaimsTest, OneSeedIsSaidBehindTheVerdict) {
  Evidence evidence;
  add(evidence, "ours", 1, {});
  EXPECT_EQ(verdict("1", evidence), "agrees (1 seed)");
}

TEST(ClaimsTest, AMissingModelIsNotRun) {
  Evidence evidence;
  add(evidence, "ours", 1, {});
  EXPECT_EQ(verdict("9", evidence), "can't tell (not run)");   // PL/Env-Rigid alone
  EXPECT_EQ(verdict("18", evidence), "can't tell (not run)");  // both
  EXPECT_EQ(verdict("66", evidence), "can't tell (not run)");  // no benchmark
}

TEST(ClaimsTest, FewerThanEightRunsAreNotRun) {
  Evidence evidence;
  add(evidence, "ours", 1, {.runs = 7, .successes = 7});
  EXPECT_EQ(verdict("1", evidence), "can't tell (not run)");
}

TEST(ClaimsTest, FewerThanEightPairsAreNotRun) {
  Evidence evidence;
  add(evidence, "ours", 1, {});
  add(evidence, "pl-rigid", 1, {.successes = 7, .top_mps = 1.65});
  EXPECT_EQ(verdict("18", evidence), "can't tell (not run)");
  add(evidence, "pl-rigid", 1, {.successes = 8, .top_mps = 1.65});
  EXPECT_EQ(verdict("18", evidence), "agrees (1 seed)");
}

TEST(ClaimsTest, AControllerThatFallsOnItsOwnGroundIsNotCompetent) {
  Evidence evidence;
  add(evidence, "ours", 1, {.alive_on_own_ground = 14});
  EXPECT_EQ(verdict("1", evidence), "can't tell (not competently trained)");
  add(evidence, "ours", 1, {.alive_on_own_ground = 15});
  EXPECT_EQ(verdict("1", evidence), "agrees (1 seed)");
}

TEST(ClaimsTest, ExcessAgreesFromHalfToTwiceAndContradictsWhenItIsTheOtherWayRound) {
  const auto with = [](double other_mps) {
    Evidence evidence;
    add(evidence, "ours", 1, {.top_mps = 3.0});
    add(evidence, "pl-gm", 1, {.top_mps = other_mps});
    return verdict("19", evidence);
  };
  EXPECT_EQ(with(2.0), "agrees (1 seed)");      // 50 % faster, the paper 50.7 %
  EXPECT_EQ(with(2.9), "can't tell (1 seed)");  // 3 %
  EXPECT_EQ(with(1.2), "can't tell (1 seed)");  // 150 %
  EXPECT_EQ(with(3.2), "contradicts (1 seed)");
}

TEST(ClaimsTest, EveryClaimOfTheRobotHalfHasARule) {
  // Those of the simulation half need models that have no file yet.
  std::set<std::string> without;
  Evidence evidence;
  for (const Claim& c : claims()) {
    if (c.section == "Simulated grounds" && c.id != "66" && c.id != "67") continue;
    const Judgement judgement = judge(c, evidence);
    EXPECT_TRUE(judgement.verdict == Verdict::kNotTestable || judgement.reason == "not run")
        << c.id;
  }
  EXPECT_EQ(claims().size(), 71u);
  EXPECT_EQ(claim("39a").section, "Other grounds");
}

// An oracle whose answers depend on T and e by this much, in the bins of sigma_flat by `bins`, and
// on sigma_flat, sigma_cone and the inertial factor by `gradients`.
struct MadeUpOracle {
  double terrain = 0.1, estimate = 0.3;
  std::vector<double> bins = {0.1, 0.2};
  std::array<double, 3> gradients = {0.3, 0.2, 0.1};
};

void add_oracle(Evidence& evidence, const std::string& oracle, const MadeUpOracle& m) {
  RunGroup group{kOracleGround, "", 0.0, {}, {}};
  for (int i = 0; i < 10; ++i) {
    group.runs["T"].push_back(m.terrain + 0.001 * i);
    group.runs["e"].push_back(m.estimate);
  }
  group.lists["bin_T"] = m.bins;
  for (const OracleJoint& joint : kOracleJoints) {
    std::vector<double>& gradients = group.lists[joint.list];
    gradients.assign(std::size(kTerrainParameters), 0.0);
    gradients[kSigmaFlat] = m.gradients[0];
    gradients[kSigmaCone] = m.gradients[1];
    gradients[kInertia] = m.gradients[2];
  }
  evidence.measured["E8"][oracle][1] = {{group}};
  evidence.measured["fairness"][oracle][1] = straight_runs({}, "own", {1.0, 2.0, 3.0}, 16);
}

std::string oracle_verdict(const std::string& id, const MadeUpOracle& h, const MadeUpOracle& o) {
  Evidence evidence;
  add_oracle(evidence, "oracle-h", h);
  add_oracle(evidence, "oracle-o", o);
  return verdict(id, evidence);
}

TEST(OracleClaimsTest, TheEstimateHasToCountTwiceAsMuchAsTheTerrainInBoth) {
  const MadeUpOracle twice{.estimate = 0.3}, once{.estimate = 0.15}, less{.estimate = 0.05};
  EXPECT_EQ(oracle_verdict("59", twice, twice), "agrees (1 seed)");
  EXPECT_EQ(oracle_verdict("59", twice, once), "can't tell (1 seed)");
  EXPECT_EQ(oracle_verdict("59", less, once), "can't tell (1 seed)");
  EXPECT_EQ(oracle_verdict("59", less, less), "contradicts (1 seed)");
}

TEST(OracleClaimsTest, WithTheHistoryTheTerrainHasToCountLess) {
  const MadeUpOracle little{.terrain = 0.1}, much{.terrain = 0.2};
  EXPECT_EQ(oracle_verdict("63", little, much), "agrees (1 seed)");
  EXPECT_EQ(oracle_verdict("63", much, much), "can't tell (1 seed)");
  EXPECT_EQ(oracle_verdict("63", much, little), "contradicts (1 seed)");
}

TEST(OracleClaimsTest, WithoutTheHistoryTheTerrainHasToCountMoreUnevenly) {
  const MadeUpOracle even{.bins = {0.9, 1.0, 1.1}}, little{.bins = {0.89, 1.0, 1.11}};
  const MadeUpOracle much{.bins = {0.5, 1.0, 1.5}};
  EXPECT_EQ(oracle_verdict("64", even, much), "agrees (1 seed)");
  EXPECT_EQ(oracle_verdict("64", even, little), "can't tell (1 seed)");
  EXPECT_EQ(oracle_verdict("64", much, little), "contradicts (1 seed)");
}

TEST(OracleClaimsTest, BothStiffnessesHaveToCountMoreThanTheInertia) {
  const auto of = [](const std::array<double, 3>& gradients) {
    return oracle_verdict("65", {}, {.gradients = gradients});
  };
  EXPECT_EQ(of({0.3, 0.2, 0.1}), "agrees (1 seed)");
  EXPECT_EQ(of({0.3, 0.1, 0.2}), "can't tell (1 seed)");
  EXPECT_EQ(of({0.1, 0.2, 0.3}), "contradicts (1 seed)");
}

TEST(OracleClaimsTest, AMissingOracleIsNotRun) {
  Evidence evidence;
  add_oracle(evidence, "oracle-h", {});
  EXPECT_EQ(verdict("59", evidence), "can't tell (not run)");
  EXPECT_EQ(verdict("65", evidence), "can't tell (not run)");
}

TEST(ClaimsTest, TheTableIsReadAsItIsWritten) {
  const std::vector<Claim> read = read_claims(
      "| verdict | meaning |\n|---|---|\n| agrees | yes |\n\n## Part\n"
      "| id | the paper | our figure | agrees if | contradicts if |\n|---|---|---|---|---|\n"
      "| 1 | \"a\" | b | c | |\n\ntext\n");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].id, "1");
  EXPECT_EQ(read[0].quote, "\"a\"");
  EXPECT_EQ(read[0].agrees_if, "c");
  EXPECT_EQ(read[0].contradicts_if, "");
  EXPECT_EQ(read[0].section, "Part");
}

}  // namespace
}  // namespace sandrunner::study
