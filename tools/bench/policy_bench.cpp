// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <list>
#include <random>
#include <thread>
#include <utility>

#include "policy/eight_floats.h"
#include "policy/network.h"
#include "policy/perceptron.h"
#include "rt/base/clock_ns.h"
#include "rt/base/processor_name.h"
#include "rt/core/processor.h"
#include "rt/realtime/setup.h"
#include "tools/bench/benches.h"

namespace sandrunner::bench {
namespace {

constexpr int kWarmUpSteps = 100;
constexpr int kHotSteps = 2000;
constexpr int kColdSteps = 20;
/// Walks on the core between cold steps: of more than its own caches hold, and of more than the
/// shared cache mostly does.
constexpr std::size_t kWalkBytes = 16 << 20, kLongWalkBytes = 64 << 20;
/// The kernel stops real-time threads that take more than 95 % of a second.
constexpr auto kRest = std::chrono::milliseconds(10);
constexpr int kObservations = 16;

using Observation = std::array<float, kObservationSize>;

/// On one core and, where allowed, in real time; as before when it goes.
class RealtimeScope {
 public:
  RealtimeScope() {
    pthread_getaffinity_np(pthread_self(), sizeof(cores_), &cores_);
    pthread_getschedparam(pthread_self(), &policy_, &priority_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(allowed_cpus().back(), &one);
    pinned_ = pthread_setaffinity_np(pthread_self(), sizeof(one), &one) == 0;
    const sched_param priority{.sched_priority = 20};
    fifo_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
  }
  ~RealtimeScope() {
    pthread_setschedparam(pthread_self(), policy_, &priority_);
    pthread_setaffinity_np(pthread_self(), sizeof(cores_), &cores_);
  }
  RealtimeScope(const RealtimeScope&) = delete;
  RealtimeScope& operator=(const RealtimeScope&) = delete;
  std::string description() const {
    return fmt::format("{}, {}", pinned_ ? "pinned to one core" : "not pinned",
                       fifo_ ? "SCHED_FIFO" : "SCHED_FIFO refused");
  }

 private:
  cpu_set_t cores_{};
  int policy_ = SCHED_OTHER;
  sched_param priority_{};
  bool pinned_ = false, fifo_ = false;
};

/// Weights of a size that keeps the layers' outputs near 1.
void fill_at_random(const std::vector<NamedTensor>& tensors) {
  std::mt19937 random(1);
  for (const NamedTensor& tensor : tensors) {
    const float limit = 2.0f / std::sqrt(static_cast<float>(tensor.shape.back()));
    std::uniform_real_distribution<float> weight(-limit, limit);
    for (std::size_t i = 0; i < tensor.size(); ++i) tensor.values->push_back(weight(random));
  }
}

/// The commonest network of others: rsl_rl's actor for a velocity task, 45-512-256-128-12.
PerceptronParameters random_perceptron() {
  PerceptronParameters parameters;
  parameters.observation.terms = parse_terms(
      "terms", "angular_velocity, gravity, command, joint_position, joint_velocity, last_action");
  parameters.policy_hz = kPolicyHz;
  parameters.actor = {512, 256, 128};
  for (int j = 0; j < kNumJoints; ++j) parameters.joint_of[j] = j;
  fill_at_random(tensors_of("bench", parameters));
  return parameters;
}

NetworkParameters random_parameters() {
  NetworkParameters parameters;
  fill_at_random(tensors_of(parameters));
  std::fill(parameters.observation_variance.begin(), parameters.observation_variance.end(), 1.0f);
  return parameters;
}

/// Memory that is only read: as many bytes as the weights for the floor, more for the walk.
class Bytes {
 public:
  explicit Bytes(std::size_t size) : lines_((size + sizeof(Line) - 1) / sizeof(Line)) {}

  /// One forward pass of loads into eight sums.
  void read() const {
    EightFloats sum[8];
    for (EightFloats& part : sum) part = eight_times(0.0f);
    const float* at = lines_.front().value;
    for (std::size_t i = 0; i < lines_.size(); ++i, at += 64) {
      for (int k = 0; k < 8; ++k) sum[k] = either(sum[k], load_eight(at + 8 * k));
    }
    for (const EightFloats& part : sum) {
      alignas(32) float read[8];  // the sums themselves stay in registers
      store_eight(read, part);
      asm volatile("" : : "m"(read));
    }
  }

 private:
  struct Line {
    alignas(64) float value[64] = {};
  };
  std::vector<Line> lines_;
};

}  // namespace

Report run_policy_bench(int rounds) {
  flush_denormals_to_zero();
  const RealtimeScope realtime;
  const NetworkParameters parameters = random_parameters();
  std::vector<Observation> observations(kObservations);
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  for (Observation& observation : observations) {
    for (float& value : observation) value = normal(random);
  }

  // Those of the round. New ones each round, none freed before the end: the time of a cold step
  // depends on which pages of memory it was given.
  std::list<Network> ours;
  std::list<Perceptron> theirs;
  std::list<Bytes> floors, their_floors;
  const Bytes short_walk(kWalkBytes), long_walk(kLongWalkBytes);
  NetworkState state;
  NetworkOutput output;
  const auto our_step = [&](int k) {
    ours.back().step(observations[k % kObservations], state, output);
  };
  const auto read = [&](int) { floors.back().read(); };
  NetworkState their_state;
  const auto their_step = [&](int k) {
    theirs.back().step(observations[k % kObservations], their_state, output);
  };
  const auto their_read = [&](int) { their_floors.back().read(); };
  struct Candidate {
    const char* name;
    const Bytes* walk;  ///< before a step, not timed; none: hot
    bool touch;         ///< of the weights, after the walk
    std::function<void(int)> step;
  };
  const std::vector<Candidate> candidates = {{"hot", nullptr, false, our_step},
                                             {"hot_read_floor", nullptr, false, read},
                                             {"mlp_hot", nullptr, false, their_step},
                                             {"mlp_read_floor", nullptr, false, their_read},
                                             {"l2_cold", &short_walk, false, our_step},
                                             {"l2_cold_pretouched", &short_walk, true, our_step},
                                             {"cold", &long_walk, false, our_step},
                                             {"cold_pretouched", &long_walk, true, our_step}};

  // Median over a block's steps: interruptions are not in it.
  const auto median_time_s = [&](const Candidate& candidate) {
    std::this_thread::sleep_for(kRest);
    for (int k = 0; k < kWarmUpSteps; ++k) candidate.step(k);
    std::vector<double> times_s(candidate.walk ? kColdSteps : kHotSteps);
    for (std::size_t k = 0; k < times_s.size(); ++k) {
      if (candidate.walk) candidate.walk->read();
      if (candidate.touch) ours.back().touch_weights();
      const double start_s = clock_s(CLOCK_MONOTONIC);
      candidate.step(static_cast<int>(k));
      times_s[k] = clock_s(CLOCK_MONOTONIC) - start_s;
    }
    return quartiles(std::move(times_s)).median;
  };
  Samples times_s;
  for (int round = 0; round < rounds; ++round) {
    ours.emplace_back(parameters);
    floors.emplace_back(ours.back().weight_bytes());
    theirs.emplace_back(random_perceptron(), JointArray<double>{}, 0.0);
    their_floors.emplace_back(theirs.back().weight_bytes());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Candidate& candidate = candidates[(i + round) % candidates.size()];
      times_s[candidate.name].push_back(median_time_s(candidate));
    }
  }

  Report report;
  report.facts = {
      {"processor", processor_name()},
      {"policy", fmt::format("one step of the network, {} bytes of weights as packed; {}",
                             ours.back().weight_bytes(), realtime.description())},
      {"mlp", fmt::format("a perceptron 45-512-256-128-12, ELU, {} bytes of weights as packed",
                          theirs.back().weight_bytes())},
      {"read_floor", "as many bytes, loaded into eight registers and nothing else"},
      {"l2_cold", fmt::format("after a walk through {} MiB on the same core", kWalkBytes >> 20)},
      {"cold", fmt::format("after a walk through {} MiB on the same core", kLongWalkBytes >> 20)}};
  for (const auto& [name, values] : times_s) {
    std::vector<double> rates;
    for (const double t : values) rates.push_back(1.0 / t);
    report.rates.emplace_back("policy_" + name, quartiles(rates));
  }
  const auto ratio = [&](const char* name, const char* above, const char* below) {
    add_ratio(report, name, times_s, above, below);
  };
  ratio("policy_hot_vs_read_floor", "hot", "hot_read_floor");
  ratio("policy_mlp_vs_read_floor", "mlp_hot", "mlp_read_floor");
  ratio("policy_l2_pretouched_vs_cold", "l2_cold_pretouched", "l2_cold");
  ratio("policy_pretouched_vs_cold", "cold_pretouched", "cold");
  return report;
}

}  // namespace sandrunner::bench
