// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/learner/learner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "rt/base/add_members.h"
#include "rt/base/errors.h"
#include "tools/train/learner/gae.h"
#include "tools/train/learner/random.h"

namespace sandrunner::learner {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLearningRateUp = 1.2;
constexpr double kLearningRateDown = 1.3;
constexpr int kChunkColumns = 256;     // activations of the heads that stay in a 1 MiB cache
constexpr std::size_t kRange = 16384;  // parameters of one task of reduction and optimiser

void require(bool holds, const std::string& key, double found, const std::string& expected) {
  if (!holds) throw InputError(fmt::format("learner: {} is {}, expected {}", key, found, expected));
}

/// The config, if its settings fit together and the shape. The range of each of them is that of
/// training.toml (train_config.cpp).
const LearnerConfig& checked(const LearnerConfig& config, const RolloutShape& shape) {
  require(shape.envs >= 1 && shape.envs % config.block_envs == 0, "envs", shape.envs,
          fmt::format("a multiple of block_envs, {}", config.block_envs));
  require(shape.envs / config.block_envs >= config.minibatches, "envs", shape.envs,
          fmt::format("at least a block of {} for each of {} minibatches", config.block_envs,
                      config.minibatches));
  require(config.learning_rate_start >= config.learning_rate_min &&
              config.learning_rate_start <= config.learning_rate_max,
          "learning_rate_start", config.learning_rate_start,
          "between learning_rate_min and learning_rate_max");
  require(config.action_std_start >= config.action_std_min, "action_std_start",
          config.action_std_start, "at least action_std_min");
  return config;
}

}  // namespace

void Learner::halve_learning_rate() {
  counters_.learning_rate = std::max(0.5 * counters_.learning_rate, config_.learning_rate_min);
}

double adapted_learning_rate(double learning_rate, double kl, const LearnerConfig& config) {
  if (kl < 0.5 * config.kl_target) learning_rate *= kLearningRateUp;
  if (kl > 2.0 * config.kl_target) learning_rate /= kLearningRateDown;
  return std::clamp(learning_rate, config.learning_rate_min, config.learning_rate_max);
}

Learner::Learner(const LearnerConfig& config, const RolloutShape& shape, std::uint64_t seed,
                 WorkerPool& pool, std::optional<Symmetry> symmetry, const Kernels<float>& kernels)
    : config_(checked(config, shape)),
      layout_(config.network, shape.privileged),
      pool_(pool),
      symmetry_(std::move(symmetry)),
      has_mirror_(symmetry_ && config.loss.symmetry_weight > 0.0),
      rollout_(shape, layout_.memory()),
      parameters_(initial_parameters(layout_, seed, config.action_std_start)),
      weights_(layout_),
      averaged_(parameters_),
      adam_(parameters_.size()),
      memory_(Matrix<float>::Zero(layout_.memory(), shape.envs)),
      mirror_memory_(memory_),
      asymmetry_(Matrix<float>::Zero(kActionSize, shape.envs)) {
  if (!has_mirror_) config_.loss.symmetry_weight = 0.0;
  counters_.seed = seed;
  counters_.learning_rate = config.learning_rate_start;
  const int chunk_steps = std::clamp(kChunkColumns / config.block_envs, 1, shape.steps);
  for (int worker = 0; worker < pool.threads(); ++worker) {
    acting_.emplace_back(layout_, 1, config.block_envs, 1, kernels);
    learning_.emplace_back(layout_, shape.steps, config.block_envs, chunk_steps, kernels);
  }
  const int blocks_per_minibatch = (blocks() + config.minibatches - 1) / config.minibatches;
  gradients_.assign(static_cast<std::size_t>(blocks_per_minibatch),
                    std::vector<float>(parameters_.size()));
  begin_window();
}

void Learner::act_block(int block, int t, int worker) {
  const int first = block * config_.block_envs;
  const int end = first + config_.block_envs;
  acting_[static_cast<std::size_t>(worker)].act(weights_, rollout_, t, first,
                                                memory_.middleCols(first, config_.block_envs));
  if (has_mirror_) act_in_mirror(block, t, worker);
  if (teacher_) ask_teacher(block, t, worker);

  const std::uint64_t step = counters_.steps + static_cast<std::uint64_t>(t);
  const Eigen::Array<float, kActionSize, 1> std_dev = rollout_.log_std.array().exp();
  const float log_norm =
      -0.5f * kActionSize * std::log(2.0f * std::numbers::pi_v<float>) - rollout_.log_std.sum();
  for (int env = first; env < end; ++env) {
    const auto mean = rollout_.mean(t).col(env);
    auto action = rollout_.action(t).col(env);
    float square = 0.0f;
    for (int k = 0; k < kActionSize; k += 2) {
      const auto [a, b] =
          random_normal_pair(counters_.seed, Stream::kAction, static_cast<std::uint64_t>(env),
                             step * kActionSize + static_cast<std::uint64_t>(k));
      action(k) = mean(k) + std_dev(k) * a;
      action(k + 1) = mean(k + 1) + std_dev(k + 1) * b;
      square += a * a + b * b;
    }
    rollout_.log_prob(t, env) = log_norm - 0.5f * square;
  }
}

void Learner::set_teacher(const ParameterLayout& layout, const std::vector<float>& parameters,
                          const Kernels<float>& kernels) {
  const auto widths = [](const ParameterLayout& l) {
    std::vector<int> all = {l.hidden(), l.actor_inputs()};
    for (const LayerView& layer : l.actor()) all.push_back(layer.outputs);
    return fmt::format("{}", fmt::join(all, "-"));
  };
  if (widths(layout) != widths(layout_)) {
    throw InputError(fmt::format("teacher: found encoding and actor of sizes {}, expected {}",
                                 widths(layout), widths(layout_)));
  }
  Teacher teacher{Weights<float>(layout),
                  {},
                  Matrix<float>::Zero(layout.memory(), rollout_.shape.envs),
                  fnv1a({reinterpret_cast<const char*>(parameters.data()), 4 * parameters.size()})};
  teacher.weights.set(parameters.data());
  for (int worker = 0; worker < pool_.threads(); ++worker) {
    teacher.passes.emplace_back(layout, 1, config_.block_envs, 1, kernels);
  }
  teacher_ = std::move(teacher);
  for (std::size_t i = 0; i < layout_.actor().size(); ++i) {
    const LayerView &from = layout.actor()[i], &to = layout_.actor()[i];
    std::copy_n(parameters.begin() + from.weight, std::ptrdiff_t{from.inputs} * from.outputs,
                parameters_.begin() + to.weight);
    std::copy_n(parameters.begin() + from.bias, from.outputs, parameters_.begin() + to.bias);
  }
  averaged_ = parameters_;
  begin_window();
}

void Learner::ask_teacher(int block, int t, int worker) {
  const int first = block * config_.block_envs, envs = config_.block_envs;
  BlockPass<float>& pass = teacher_->passes[static_cast<std::size_t>(worker)];
  pass.answer(teacher_->weights, rollout_.observation(t).middleCols(first, envs),
              rollout_.insight(t).middleCols(first, envs), &rollout_.reset(t, first),
              teacher_->memory.middleCols(first, envs),
              rollout_.teacher_mean(t).middleCols(first, envs));
  rollout_.teacher_encoding(t).middleCols(first, envs) = pass.encoding();
}

void Learner::act_in_mirror(int block, int t, int worker) {
  const int first = block * config_.block_envs;
  Matrix<float> observation = rollout_.observation(t).middleCols(first, config_.block_envs);
  Matrix<float> insight = rollout_.insight(t).middleCols(first, config_.block_envs);
  std::array<float, std::max(kObservationSize, kInsightSize)> scratch;
  for (int i = 0; i < config_.block_envs; ++i) {
    symmetry_->observation.apply(observation.col(i), scratch.data());
    if (insight.rows() > 0) symmetry_->insight.apply(insight.col(i), scratch.data());
  }
  Matrix<float> mean(kActionSize, config_.block_envs);
  acting_[static_cast<std::size_t>(worker)].answer(
      weights_, observation, insight, &rollout_.reset(t, first),
      mirror_memory_.middleCols(first, config_.block_envs), mean);
  const float share = 1.0f / static_cast<float>(config_.symmetry_steps);
  for (int i = 0; i < config_.block_envs; ++i) {
    symmetry_->action.apply(mean.col(i), scratch.data());
    auto asymmetry = asymmetry_.col(first + i);
    if (rollout_.reset(t, first + i) != 0) asymmetry.setZero();
    asymmetry += share * (rollout_.mean(t).col(first + i) - mean.col(i) - asymmetry);
  }
  rollout_.symmetric_mean(t).middleCols(first, config_.block_envs) =
      rollout_.mean(t).middleCols(first, config_.block_envs) -
      asymmetry_.middleCols(first, config_.block_envs);
}

void Learner::value_timeouts(int first_env, int worker) {
  BlockPass<float>& pass = acting_[static_cast<std::size_t>(worker)];
  for (int t = 0; t < rollout_.shape.steps; ++t) {
    for (int env = first_env; env < first_env + config_.block_envs; ++env) {
      if (rollout_.end(t, env) != End::kTimeout) continue;
      rollout_.timeout_value(t, env) =
          pass.value(weights_, rollout_.final_privileged(t).col(env).data());
    }
  }
}

// The other ranks' blocks of the rollout, as one message: block by block, in each the fields.
void Learner::share_rollout() {
  if (ranks_.size() == 1) return;
  const auto envs = static_cast<std::size_t>(rollout_.shape.envs);
  std::size_t bytes = 0;
  rollout_.for_each_learnt([&](std::span<std::byte> field, int) { bytes += field.size(); });
  std::vector<std::byte> packed(bytes);
  const auto copy = [&](int block, bool pack) {
    std::byte* at = packed.data() + bytes / static_cast<std::size_t>(blocks()) * block;
    rollout_.for_each_learnt([&](std::span<std::byte> field, int steps) {
      const std::size_t of_step = field.size() / static_cast<std::size_t>(steps);
      const std::size_t of_block = of_step / envs * config_.block_envs;
      if (of_block == 0) return;  // a field without rows
      for (int t = 0; t < steps; ++t, at += of_block) {
        std::byte* const here = field.data() + t * of_step + block * of_block;
        std::memcpy(pack ? at : here, pack ? here : at, of_block);
      }
    });
  };
  const Share own = own_blocks();
  pool_.run(own.size(), [&](int i, int) { copy(own.begin + i, true); });
  ranks_.gather(std::span(packed), blocks());
  pool_.run(blocks(), [&](int block, int) {
    if (block < own.begin || block >= own.end) copy(block, false);
  });
}

void Learner::compute_advantages(UpdateStats& stats) {
  struct Sums {
    double advantage = 0.0;
    double advantage_square = 0.0;
    double target = 0.0;
    double target_square = 0.0;
  };
  const Share own = own_blocks();
  pool_.run(own.size(), [&](int i, int worker) {
    const int first = (own.begin + i) * config_.block_envs;
    acting_[static_cast<std::size_t>(worker)].evaluate(weights_, rollout_, rollout_.shape.steps,
                                                       first);
    value_timeouts(first, worker);
    compute_gae(rollout_, first, config_.block_envs, config_.gamma, config_.lambda);
  });
  share_rollout();
  std::vector<Sums> sums(static_cast<std::size_t>(blocks()));
  pool_.run(blocks(), [&](int block, int) {
    const int first = block * config_.block_envs;
    Sums& sum = sums[static_cast<std::size_t>(block)];
    for (int t = 0; t < rollout_.shape.steps; ++t) {
      for (int env = first; env < first + config_.block_envs; ++env) {
        const double advantage = rollout_.advantage(t, env);
        const double target = rollout_.value_target(t, env);
        sum.advantage += advantage;
        sum.advantage_square += advantage * advantage;
        sum.target += target;
        sum.target_square += target * target;
      }
    }
  });
  Sums total;
  for (const Sums& sum : sums) add_members<double>(sum, total);
  const double n = static_cast<double>(rollout_.shape.envs) * rollout_.shape.steps;
  const double mean = total.advantage / n;
  const double variance = std::max(0.0, total.advantage_square / n - mean * mean);
  const double target_mean = total.target / n;
  const double target_variance = std::max(0.0, total.target_square / n - target_mean * target_mean);
  advantage_scale_ = {mean, 1.0 / (std::sqrt(variance) + 1e-8)};
  // The advantage is the difference of target and value.
  stats.explained_variance = target_variance > 0.0 ? 1.0 - variance / target_variance : 0.0;
}

std::vector<int> Learner::shuffled_blocks(int epoch) const {
  std::vector<int> order(static_cast<std::size_t>(blocks()));
  std::iota(order.begin(), order.end(), 0);
  const std::uint64_t round = counters_.updates * static_cast<std::uint64_t>(config_.epochs) +
                              static_cast<std::uint64_t>(epoch);
  for (std::size_t i = order.size() - 1; i > 0; --i) {
    const std::uint64_t bits = counter_bits(counters_.seed, Stream::kShuffle, round, i);
    std::swap(order[i], order[static_cast<std::size_t>(bits % (i + 1))]);
  }
  return order;
}

double Learner::reduce_gradients(int count) {
  const std::size_t size = parameters_.size();
  const std::size_t ranges = (size + kRange - 1) / kRange;
  std::vector<double> squares(ranges, 0.0);
  ranks_.add_up(gradients_, count, pool_);
  pool_.run(static_cast<int>(ranges), [&](int range, int) {
    const std::size_t begin = static_cast<std::size_t>(range) * kRange;
    const std::size_t end = std::min(size, begin + kRange);
    const std::vector<float>& sum = gradients_.front();
    double square = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      square += static_cast<double>(sum[k]) * static_cast<double>(sum[k]);
    }
    squares[static_cast<std::size_t>(range)] = square;
  });
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0));
}

bool Learner::learn_minibatch(const int* blocks, int count, UpdateStats& stats) {
  const int samples = count * config_.block_envs * rollout_.shape.steps;
  std::vector<LossSums> sums(static_cast<std::size_t>(count));
  weights_.set(parameters_.data());
  const Share own = ranks_.share(count);
  pool_.run(own.size(), [&](int i, int worker) {
    const int place = own.begin + i;
    const auto slot = static_cast<std::size_t>(place);
    std::fill(gradients_[slot].begin(), gradients_[slot].end(), 0.0f);
    sums[slot] = learning_[static_cast<std::size_t>(worker)].loss_and_gradient(
        weights_, rollout_, blocks[slot] * config_.block_envs, config_.loss, advantage_scale_,
        samples, gradients_[slot].data());
  });
  ranks_.gather(std::span(sums), count);
  LossSums total;
  for (const LossSums& sum : sums) add_members<double>(sum, total);
  const double norm = reduce_gradients(count);

  const double estimate_squares =
      std::accumulate(total.estimate_square.begin(), total.estimate_square.end(), 0.0);
  if (!std::isfinite(norm + total.policy + total.value + estimate_squares + total.kl +
                     total.imitation))
    return false;
  const double kl = total.kl / total.samples;
  for (std::size_t k = 0; k < kEstimateSize; ++k) {
    stats.estimate_rms[k] += total.estimate_square[k] / total.samples;
  }
  stats.kl += kl;
  stats.asymmetry += has_mirror_ ? 2.0 * total.asymmetry / total.samples / kActionSize : kNan;
  stats.imitation_rms += total.imitation / total.samples;
  stats.encoding_rms += total.encoding / total.samples;

  counters_.learning_rate = adapted_learning_rate(counters_.learning_rate, kl, config_);
  const double scale = norm > config_.max_gradient_norm ? config_.max_gradient_norm / norm : 1.0;
  ++adam_.step;
  const std::size_t size = parameters_.size();
  pool_.run(static_cast<int>((size + kRange - 1) / kRange), [&](int range, int) {
    const std::size_t begin = static_cast<std::size_t>(range) * kRange;
    adam_.update(begin, std::min(size, begin + kRange), counters_.learning_rate,
                 static_cast<float>(scale), gradients_.front().data(), parameters_.data());
  });
  const auto most = static_cast<float>(std::log(action_std_most_));
  const auto least = std::min(static_cast<float>(std::log(config_.action_std_min)), most);
  float* log_std = parameters_.data() + layout_.log_std();
  for (int k = 0; k < kActionSize; ++k) log_std[k] = std::clamp(log_std[k], least, most);
  if (symmetry_) {  // as much noise on the left as on the right
    std::array<float, kActionSize> both;
    for (std::size_t k = 0; k < kActionSize; ++k) {
      both[k] = 0.5f * (log_std[k] + log_std[symmetry_->action.index[k]]);
    }
    std::copy(both.begin(), both.end(), log_std);
  }
  return true;
}

UpdateStats Learner::update() {
  UpdateStats stats;
  compute_advantages(stats);
  const std::vector<float> parameters_before = parameters_;
  const Adam adam_before = adam_;
  const double learning_rate_before = counters_.learning_rate;
  int done = 0;
  for (int epoch = 0; epoch < config_.epochs && stats.finite; ++epoch) {
    const std::vector<int> order = shuffled_blocks(epoch);
    for (int i = 0; i < config_.minibatches && stats.finite; ++i) {
      const int begin = blocks() * i / config_.minibatches;
      const int end = blocks() * (i + 1) / config_.minibatches;
      stats.finite = learn_minibatch(order.data() + begin, end - begin, stats);
      ++done;
    }
  }
  if (!stats.finite) {
    parameters_ = parameters_before;
    adam_ = adam_before;
    counters_.learning_rate = learning_rate_before;
  }
  for (double& square : stats.estimate_rms) square = std::sqrt(square / done);
  stats.kl /= done;
  stats.asymmetry = std::sqrt(stats.asymmetry / done);
  stats.imitation_rms = std::sqrt(stats.imitation_rms / done);
  stats.encoding_rms = std::sqrt(stats.encoding_rms / done);
  stats.learning_rate = counters_.learning_rate;

  rollout_.begin_next(0, rollout_.shape.envs);
  ++counters_.updates;
  // Equal weights at first, so that the random start is soon forgotten.
  const auto share = static_cast<float>(
      1.0 / std::min(static_cast<double>(counters_.updates), double(config_.average_updates)));
  for (std::size_t i = 0; i < averaged_.size(); ++i) {
    averaged_[i] += share * (parameters_[i] - averaged_[i]);
  }
  counters_.steps += static_cast<std::uint64_t>(rollout_.shape.steps);
  begin_window();
  stats.action_std = std::exp(static_cast<double>(rollout_.log_std.mean()));
  return stats;
}

void Learner::begin_window() {
  weights_.set(parameters_.data());
  rollout_.initial_memory(0) = memory_;
  rollout_.log_std =
      Eigen::Map<const Vector<float>>(parameters_.data() + layout_.log_std(), kActionSize);
}

}  // namespace sandrunner::learner
