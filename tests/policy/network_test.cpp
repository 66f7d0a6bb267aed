// SPDX-License-Identifier: BSD-3-Clause
#include "policy/network.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <sstream>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "tests/policy/allocation_counter.h"
#include "tests/policy/random_policy.h"

namespace sandrunner {
namespace {

/// Rows of numbers of a CSV file with one header line.
std::vector<std::vector<float>> read_csv(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  std::vector<std::vector<float>> rows;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stof(cell));
  }
  return rows;
}

template <typename Values>
void expect_near(const Values& found, const float* expected, std::size_t row) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i], expected[i], 1e-5) << "row " << row << ", value " << i;
  }
}

TEST(NetworkTest, MatchesGoldenStepsOfThePublishedNetwork) {
  const std::string folder = SANDRUNNER_SHARED_DIR "/reference-policy/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference policy at " << folder;
  const PolicyFile file = read_bare_weights(folder + "reference.safetensors");
  const Network network(file.parameters);
  Policy policy(file.spec, network);
  NetworkState state;
  NetworkOutput output;
  const auto rows = read_csv(folder + "golden-policy.csv");
  ASSERT_EQ(rows.size(), 50u);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(rows[k].size(), 126u);
    std::array<float, kObservationSize> observation;
    std::copy_n(&rows[k][1], kObservationSize, observation.begin());
    network.step(observation, state, output);
    expect_near(state.h, &rows[k][34], k);
    expect_near(output.estimate_raw, &rows[k][98], k);
    const StateEstimate estimate = policy.step(observation).estimate;
    EXPECT_NEAR(estimate.body_height_m, rows[k][106], 1e-5);
    expect_near(estimate.velocity_mps, &rows[k][107], k);
    expect_near(estimate.foot_height_m, &rows[k][110], k);
    expect_near(output.action, &rows[k][114], k);
  }
}

TEST(NetworkTest, AgreesWithPlainDoubleEvaluation) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const PolicyFile file = random_policy_file(seed);
    EXPECT_LT(check_golden_example("random", Network(file.parameters), file.golden), 3e-6);
  }
}

void add_to_hash(const void* data, std::size_t size, std::uint64_t& hash) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;  // FNV-1a
}

TEST(NetworkTest, GivesTheSameBitsFromEveryCompiler) {
  const Network network(random_policy_file().parameters);
  NetworkState state;
  NetworkOutput output;
  RandomFloats random(7);
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (int k = 0; k < 1000; ++k) {
    network.step(random.observation(), state, output);
    add_to_hash(output.action.data(), sizeof(output.action), hash);
    add_to_hash(output.estimate_raw.data(), sizeof(output.estimate_raw), hash);
    add_to_hash(&state, sizeof(state), hash);
  }
  EXPECT_EQ(hash, 0xa519fc3f859029afu) << std::hex << hash;
}

TEST(NetworkTest, RestoredStateContinuesToTheSameBits) {
  const Network network(random_policy_file().parameters);
  RandomFloats random(3);
  std::vector<std::array<float, kObservationSize>> observations;
  for (int k = 0; k < 40; ++k) observations.push_back(random.observation());
  NetworkState state;
  NetworkState middle;
  NetworkOutput first;
  NetworkOutput second;
  for (int k = 0; k < 40; ++k) {
    if (k == 20) middle = state;
    network.step(observations[k], state, first);
  }
  for (int k = 20; k < 40; ++k) network.step(observations[k], middle, second);
  EXPECT_EQ(std::memcmp(&state, &middle, sizeof(state)), 0);
  EXPECT_EQ(first.action, second.action);
  EXPECT_EQ(first.estimate_raw, second.estimate_raw);
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

TEST(NetworkTest, StepDoesNotAllocate) {
  const Network network(random_policy_file().parameters);
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

TEST(NetworkTest, RefusesParametersOfAnotherSize) {
  NetworkParameters parameters = random_policy_file().parameters;
  parameters.actor[1].weight.pop_back();
  try {
    const Network network(parameters);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "network: tensor 'actor.1.weight' has 32767 values, expected 32768");
  }
}

}  // namespace
}  // namespace sandrunner
