// SPDX-License-Identifier: BSD-3-Clause
#include "policy/network.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <string>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "tests/policy/allocation_counter.h"
#include "tests/policy/random_policy.h"
#include "tests/support/csv.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

/// `found` is what the row holds under "<name>0", "<name>1", ...
template <typename Values>
void expect_near(const Values& found, const CsvRow& row, const std::string& name, int first = 0) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::string column = name + std::to_string(static_cast<std::size_t>(first) + i);
    EXPECT_NEAR(found[i], row.at(column), 1e-5) << column << " of step " << row.at("k");
  }
}

/// Steps a network through the rows of a table: number of the step k, raw observation obs, output
/// of the LSTM h, estimate before scaling est_raw, estimate est, action before scaling act.
void expect_golden_steps(const std::string& weights, const std::string& table) {
  const PolicyFile file = read_bare_weights(weights);
  const Network network(file.parameters);
  Policy policy(file.spec, network);
  NetworkState state;
  NetworkOutput output;
  const auto expect_row = [&](const CsvRow& row) {
    std::array<float, kObservationSize> observation;
    for (std::size_t i = 0; i < observation.size(); ++i) {
      observation[i] = static_cast<float>(row.at("obs" + std::to_string(i)));
    }
    network.step(observation, state, output);
    expect_near(state.h, row, "h");
    expect_near(output.estimate_raw, row, "est_raw");
    expect_near(output.action, row, "act");
    const StateEstimate estimate = policy.step(observation).estimate;
    EXPECT_NEAR(estimate.body_height_m, row.at("est0"), 1e-5);
    expect_near(estimate.velocity_mps, row, "est", 1);
    expect_near(estimate.foot_height_m, row, "est", 4);
  };
  const std::vector<CsvRow> rows = read_csv(table);
  ASSERT_EQ(rows.size(), 50u);
  for (const CsvRow& row : rows) expect_row(row);
  // From zero memory again.
  state = {};
  policy.reset();
  for (std::size_t k = 0; k < 5; ++k) expect_row(rows[k]);
}

TEST(NetworkTest, MatchesGoldenStepsOfANetworkEvaluatedByNumpy) {
  expect_golden_steps(SANDRUNNER_GOLDEN_DIR "/random_network.safetensors",
                      SANDRUNNER_GOLDEN_DIR "/random_network.csv");
}

TEST(NetworkTest, MatchesGoldenStepsOfThePublishedNetwork) {
  const std::string folder = SANDRUNNER_SHARED_DIR "/reference-policy/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference policy at " << folder;
  expect_golden_steps(folder + "reference.safetensors", folder + "golden-policy.csv");
}

const Wiring kTcnWiring = {EncoderKind::kTcn, {}};
const Wiring kStudent = {EncoderKind::kLstm, {true, false, true, false}};

TEST(NetworkTest, AgreesWithPlainDoubleEvaluation) {
  for (const Wiring& wiring : {Wiring{}, kTcnWiring, kStudent}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const PolicyFile file = random_policy_file(seed, wiring);
      EXPECT_LT(check_golden_example("random", Network(file.parameters), file.golden), 3e-6)
          << wiring_text(wiring);
    }
  }
}

TEST(NetworkTest, RunsNoNetworkThatSeesTheInsight) {
  EXPECT_THROW(require_runnable(random_policy_file(1, {EncoderKind::kInsight, {}}).parameters),
               InputError);
}

// The first step and one after a reset alike; the 53rd step after an observation forgets it.
TEST(NetworkTest, ATcnSeesTheLast53Observations) {
  const Network network(random_policy_file(1, kTcnWiring).parameters);
  RandomFloats random(3);
  NetworkState a, b;
  NetworkOutput of_a, of_b;
  network.step(random.observation(), a, of_a);
  network.step(random.observation(), b, of_b);
  for (int k = 1; k < kTcnPast + 1; ++k) {
    const auto observation = random.observation();
    network.step(observation, a, of_a);
    network.step(observation, b, of_b);
    EXPECT_NE(of_a.action, of_b.action) << k;
  }
  const auto observation = random.observation();
  network.step(observation, a, of_a);
  network.step(observation, b, of_b);
  EXPECT_EQ(of_a.action, of_b.action);
}

void add_to_hash(const void* data, std::size_t size, std::uint64_t& hash) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;  // FNV-1a
}

std::uint64_t hash_of_steps(const Wiring& wiring) {
  const Network network(random_policy_file(1, wiring).parameters);
  NetworkState state;
  NetworkOutput output;
  RandomFloats random(7);
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (int k = 0; k < 1000; ++k) {
    network.step(random.observation(), state, output);
    add_to_hash(output.action.data(), sizeof(output.action), hash);
    add_to_hash(output.estimate_raw.data(), sizeof(output.estimate_raw), hash);
    add_to_hash(&state, offsetof(NetworkState, past), hash);
  }
  return hash;
}

TEST(NetworkTest, GivesTheSameBitsFromEveryCompiler) {
  EXPECT_EQ(hash_of_steps({}), 0xa519fc3f859029afu);
  EXPECT_EQ(hash_of_steps(kTcnWiring), 0x3eaeb421f9a9f35u);
}

TEST(NetworkTest, DependsOnObservationsBeyondTheClipOnlyByTheirSign) {
  const PolicyFile file = random_policy_file();
  const Network network(file.parameters);
  std::array<float, kObservationSize> far;
  std::array<float, kObservationSize> farther;
  far.fill(1e3f);
  farther.fill(1e6f);
  NetworkState state_a;
  NetworkState state_b;
  NetworkOutput a;
  NetworkOutput b;
  network.step(far, state_a, a);
  network.step(farther, state_b, b);
  EXPECT_EQ(a.action, b.action);
  farther.fill(-1e6f);
  network.step(farther, state_b, b);
  EXPECT_NE(a.action, b.action);
}

TEST(NetworkTest, NaNInTheObservationReachesTheOutputs) {
  const Network network(random_policy_file().parameters);
  for (const int index : {0, kObservationSize - 1}) {
    std::array<float, kObservationSize> observation{};
    observation[index] = std::numeric_limits<float>::quiet_NaN();
    NetworkState state;
    NetworkOutput output;
    network.step(observation, state, output);
    for (const float action : output.action) EXPECT_TRUE(std::isnan(action)) << index;
  }
}

class NetworkStepTest : public testing::TestWithParam<Wiring> {};

INSTANTIATE_TEST_SUITE_P(Wirings, NetworkStepTest, testing::Values(Wiring{}, kTcnWiring, kStudent),
                         [](const auto& test) { return "Wiring" + std::to_string(test.index); });

TEST_P(NetworkStepTest, DoesNotAllocate) {
  const Network network(random_policy_file(1, GetParam()).parameters);
  NetworkState state;
  NetworkOutput output;
  RandomFloats random(5);
  const std::size_t before = number_of_allocations();
  for (int k = 0; k < 10; ++k) {
    network.touch_weights();
    network.step(random.observation(), state, output);
  }
  EXPECT_EQ(number_of_allocations(), before);
  ::operator delete(::operator new(8));
  EXPECT_EQ(number_of_allocations(), before + 1) << "the counter does not count";
}

TEST_P(NetworkStepTest, FromARestoredStateContinuesToTheSameBits) {
  const Network network(random_policy_file(1, GetParam()).parameters);
  RandomFloats random(3);
  std::vector<std::array<float, kObservationSize>> observations(40);
  for (auto& observation : observations) observation = random.observation();
  NetworkState state;
  NetworkState middle;
  NetworkOutput first;
  NetworkOutput second;
  for (int k = 0; k < 40; ++k) {
    if (k == 20) middle = state;
    network.step(observations[k], state, first);
  }
  for (int k = 20; k < 40; ++k) network.step(observations[k], middle, second);
  // The same bits. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  EXPECT_EQ(std::memcmp(&state, &middle, sizeof(state)), 0);
  EXPECT_EQ(first.action, second.action);
  EXPECT_EQ(first.estimate_raw, second.estimate_raw);
}

/// How many mappings of this process the kernel may move to huge pages whenever it likes.
int mappings_to_be_joined() {
  std::ifstream maps("/proc/self/smaps");
  int count = 0;
  for (std::string line; std::getline(maps, line);) {
    if (line.starts_with("VmFlags:") && line.find(" hg") != std::string::npos) ++count;
  }
  return count;
}

// Such a move was seen as a page fault of the policy thread.
TEST(NetworkTest, KernelMovesNoWeightsOnceTheyAreLoaded) {
  const int before = mappings_to_be_joined();
  const Network network(random_policy_file().parameters);
  EXPECT_EQ(mappings_to_be_joined(), before);
}

TEST(NetworkTest, RefusesParametersOfAnotherSize) {
  NetworkParameters parameters = random_policy_file().parameters;
  parameters.actor[1].weight.pop_back();
  EXPECT_EQ(error_of([&] { require_runnable(parameters); }),
            "network: tensor 'actor.1.weight' has 32767 values, expected 32768");
}

}  // namespace
}  // namespace sandrunner
