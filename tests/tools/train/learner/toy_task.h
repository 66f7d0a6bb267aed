// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tools/train/learner/learner.h"
#include "tools/train/learner/random.h"

namespace sandrunner::learner {

inline constexpr int kToyPrivileged = 3;

/// The toy task for -x is that for x, with the actions the other way round.
inline Symmetry toy_symmetry() {
  Symmetry s;
  const auto fill = [](Reflection& reflection, int size, float sign) {
    for (int i = 0; i < size; ++i) {
      reflection.index.push_back(i);
      reflection.sign.push_back(sign);
    }
  };
  fill(s.observation, kObservationSize, -1.0f);
  s.observation.sign[kCommandSize + 1] = 1.0f;  // gain
  fill(s.action, kActionSize, -1.0f);
  return s;
}

/// A task that only a memory solves, embedded in the robot's interface: x' = x + 0.25 gain u with
/// |u| <= 2, to be kept at 0. The gain, of random sign and size, is drawn anew in each episode and
/// not observed: which way an action pushes shows only in what happened to x. Observed: x, and the
/// last action. Estimate 0 and insight 0: the gain.
class ToyTask {
 public:
  ToyTask(Learner& learner, WorkerPool& pool, bool memory = true)
      : states(static_cast<std::size_t>(learner.rollout().shape.envs)),
        learner_(learner),
        pool_(pool),
        memory_(memory) {
    for (int env = 0; env < learner.rollout().shape.envs; ++env) {
      begin_episode(env);
      observe(env, 0, true);
    }
  }

  /// Acts a whole window; returns the mean reward, of a learner that is alone. The learner's
  /// `update` comes next.
  double run_window() {
    Rollout& rollout = learner_.rollout();
    const int block_envs = learner_.config().block_envs;
    const Share own = learner_.own_blocks();
    pool_.run(own.size(), [&](int i, int worker) {
      const int block = own.begin + i;
      for (int t = 0; t < rollout.shape.steps; ++t) {
        learner_.act_block(block, t, worker);
        for (int env = block * block_envs; env < (block + 1) * block_envs; ++env) {
          step(env, t);
        }
      }
    });
    double sum = 0.0;
    for (int t = 0; t < rollout.shape.steps; ++t) {
      for (int env = 0; env < rollout.shape.envs; ++env) sum += rollout.reward(t, env);
    }
    return sum / (rollout.shape.steps * rollout.shape.envs);
  }

  struct State {  // no padding: compared byte by byte
    float x = 0.0f;
    float gain = 0.0f;
    std::uint32_t time = 0;
    std::uint32_t episode = 0;
  };
  std::vector<State> states;

 private:
  static constexpr std::uint32_t kEpisodeSteps = 24;

  void begin_episode(int env) {
    State& state = states[static_cast<std::size_t>(env)];
    ++state.episode;
    const std::uint64_t bits =
        counter_bits(99, Stream::kInitialization, static_cast<std::uint64_t>(env), state.episode);
    const auto unit = [&](int shift) {
      return static_cast<float>((bits >> shift) & 0xffff) / 65536.0f;
    };
    state.x = 2.0f * unit(0) - 1.0f;
    state.gain = (0.6f + 0.6f * unit(16)) * (unit(32) < 0.5f ? -1.0f : 1.0f);
    // Ends of episodes are spread over the windows from the start.
    state.time = state.episode == 1 ? static_cast<std::uint32_t>(env) % kEpisodeSteps : 0;
  }

  void privileged(const State& state, float* out) const {
    out[0] = state.x;
    out[1] = state.gain;
    out[2] = state.x * state.gain;
  }

  void observe(int env, int t, bool new_episode) {
    const State& state = states[static_cast<std::size_t>(env)];
    Rollout& rollout = learner_.rollout();
    rollout.observation(t)(kCommandSize, env) = state.x;
    rollout.observation(t)(kCommandSize + 1, env) = state.time == 0 ? state.gain : 0.0f;
    rollout.estimate_target(t)(0, env) = state.gain;
    privileged(state, &rollout.privileged(t)(0, env));
    if (rollout.shape.insight > 0) rollout.insight(t)(0, env) = state.gain;
    rollout.reset(t, env) = new_episode || !memory_ ? 1 : 0;
  }

  void step(int env, int t) {
    State& state = states[static_cast<std::size_t>(env)];
    Rollout& rollout = learner_.rollout();
    state.x += 0.25f * state.gain * std::clamp(rollout.action(t)(0, env), -2.0f, 2.0f);
    ++state.time;
    rollout.reward(t, env) = 0.2f / (1.0f + 20.0f * state.x * state.x);
    rollout.end(t, env) = End::kNone;
    if (std::abs(state.x) > 3.0f) {
      rollout.end(t, env) = End::kTerminated;
      begin_episode(env);
    } else if (state.time == kEpisodeSteps) {
      rollout.end(t, env) = End::kTimeout;
      privileged(state, &rollout.final_privileged(t)(0, env));
      begin_episode(env);
    }
    observe(env, t + 1, rollout.end(t, env) != End::kNone);
  }

  Learner& learner_;
  WorkerPool& pool_;
  bool memory_;
};

}  // namespace sandrunner::learner
