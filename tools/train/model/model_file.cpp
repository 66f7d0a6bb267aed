// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/model/model_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "policy/policy_file.h"
#include "policy/safetensors.h"
#include "policy/text.h"
#include "rt/base/config_tree.h"
#include "rt/base/errors.h"
#include "rt/core/split_mix.h"
#include "tools/train/model/study_model.h"
#include "tools/train/task/leg_modes.h"

namespace sandrunner::train {
namespace {

using learner::kInsightSize;
using learner::LayerView;
using learner::ParameterLayout;

constexpr const char* kFormat = "study 1";

/// Where the tensors of critic and noise begin, which a model doesn't have.
std::ptrdiff_t end_of_policy(const ParameterLayout& layout) {
  return layout.critic().front().weight;
}

/// The sizes are those of every training; its settings hold the wiring.
learner::NetworkSizes sizes_of(const std::string& path, const PolicySpec& spec) {
  const auto config = spec.provenance.find("config");
  if (config == spec.provenance.end()) {
    fail_file(path, "metadata key 'provenance.config' is missing, which holds the wiring");
  }
  ConfigTree tree;
  tree.add_text(config->second, "'" + path + "': provenance.config");
  learner::NetworkSizes sizes;
  sizes.encoder =
      learner::parse_encoder("'" + path + "': network.encoder", tree.text("network.encoder", ""));
  sizes.actor_sees =
      learner::parse_actor_inputs("'" + path + "': network.actor", tree.text("network.actor", ""));
  return sizes;
}

std::vector<std::size_t> shape_of(const learner::TensorView& view) {
  const auto rows = static_cast<std::size_t>(view.rows);
  if (view.name.ends_with(".bias")) return {rows};
  return {rows, static_cast<std::size_t>(view.cols)};
}

/// All tensors of a file but the network's, and where they are kept.
std::vector<NamedTensor> other_tensors(StudyModelFile& file, std::vector<float>& estimate_mean,
                                       std::vector<float>& estimate_variance) {
  std::vector<NamedTensor> tensors = {
      {"observation.mean", {kObservationSize}, &file.scales.mean},
      {"observation.variance", {kObservationSize}, &file.scales.variance},
      {"estimate.mean", {kEstimateSize}, &estimate_mean},
      {"estimate.variance", {kEstimateSize}, &estimate_variance},
      {"golden.observation", {kGoldenSteps, kObservationSize}, &file.golden.observation},
      {"golden.action", {kGoldenSteps, kNumJoints}, &file.golden.action},
      {"golden.estimate", {kGoldenSteps, kEstimateSize}, &file.golden.estimate_raw}};
  if (file.sizes.see_insight()) {
    tensors.push_back({"golden.insight", {kGoldenSteps, kInsightSize}, &file.golden_insight});
  }
  return tensors;
}

/// Moves a tensor out of the file.
std::vector<float> take(const std::string& path, const std::string& name,
                        const std::vector<std::size_t>& shape, TensorFile& content) {
  auto node = content.tensors.extract(name);
  if (node.empty()) fail_file(path, "tensor '{}' is missing", name);
  if (node.mapped().shape != shape) {
    fail_file(path, "tensor '{}' has shape [{}], expected [{}]", name,
              printable(joined(node.mapped().shape, ", ")), joined(shape, ", "));
  }
  return std::move(node.mapped().values);
}

void require_variance(const std::string& path, const char* name,
                      const std::vector<float>& variance) {
  for (const float value : variance) {
    if (value < 0.0f) {
      fail_file(path, "tensor '{}' has the value {}, expected at least 0", name, value);
    }
  }
}

/// Insight counts only if a network sees it; then the golden run has it.
const float* insight_at(const StudyModelFile& file, int step) {
  static constexpr std::array<float, kInsightSize> kNone{};
  return file.sizes.see_insight()
             ? &file.golden_insight[static_cast<std::size_t>(step) * kInsightSize]
             : kNone.data();
}

/// 50 steps of random input of unit variance, with the answers of the network in double.
void make_golden(StudyModelFile& file) {
  std::uint64_t state = 0;
  const auto uniform = [&] {
    return std::sqrt(3.0) * (static_cast<double>(next_bits(state) >> 11) * 0x1p-52 - 1.0);
  };
  file.golden = {};
  file.golden_insight.clear();
  ModelNetwork<double> network(file);
  for (int k = 0; k < kGoldenSteps; ++k) {
    for (std::size_t i = 0; i < kObservationSize; ++i) {
      const double deviation = std::sqrt(static_cast<double>(file.scales.variance[i]));
      file.golden.observation.push_back(
          static_cast<float>(file.scales.mean[i] + deviation * uniform()));
    }
    for (int i = 0; file.sizes.see_insight() && i < kInsightSize; ++i) {
      file.golden_insight.push_back(static_cast<float>(uniform()));
    }
    network.step(&file.golden.observation[static_cast<std::size_t>(k) * kObservationSize],
                 insight_at(file, k));
    for (int i = 0; i < kNumJoints; ++i) {
      file.golden.action.push_back(static_cast<float>(network.action(i)));
    }
    for (int i = 0; i < kEstimateSize; ++i) {
      file.golden.estimate_raw.push_back(static_cast<float>(network.estimate(i)));
    }
  }
}

void check_golden(const std::string& path, const StudyModelFile& file) {
  ModelNetwork<float> network(file);
  const auto check = [&](int step, const char* what, int i, float found, float expected) {
    const double wanted = expected;
    if (!(std::abs(found - wanted) <= kGoldenTolerance * std::max(1.0, std::abs(wanted)))) {
      fail_file(path, "golden example fails at step {}: {}[{}] is {}, expected {:.9g}", step, what,
                i, found, wanted);
    }
  };
  for (int k = 0; k < kGoldenSteps; ++k) {
    const auto row = static_cast<std::size_t>(k);
    network.step(&file.golden.observation[row * kObservationSize], insight_at(file, k));
    for (int i = 0; i < kNumJoints; ++i) {
      check(k, "action", i, network.action(i),
            file.golden.action[row * kNumJoints + static_cast<std::size_t>(i)]);
    }
    for (int i = 0; i < kEstimateSize; ++i) {
      check(k, "estimate", i, network.estimate(i),
            file.golden.estimate_raw[row * kEstimateSize + static_cast<std::size_t>(i)]);
    }
  }
}

StudyModelFile decode(const std::string& path, TensorFile content) {
  StudyModelFile file;
  file.spec = read_spec(path, kFormat, content.metadata, file.scales.clip);
  file.sizes = sizes_of(path, file.spec);
  const ParameterLayout layout = model_layout(file.sizes);
  file.parameters.assign(static_cast<std::size_t>(layout.size()), 0.0f);
  for (const learner::TensorView& view : layout.tensors()) {
    if (view.offset >= end_of_policy(layout)) continue;
    std::ranges::copy(take(path, view.name, shape_of(view), content),
                      file.parameters.begin() + view.offset);
  }
  std::vector<float> estimate_mean, estimate_variance;
  for (const NamedTensor& want : other_tensors(file, estimate_mean, estimate_variance)) {
    *want.values = take(path, want.name, want.shape, content);
  }
  if (!content.tensors.empty()) {
    fail_file(path, "unknown tensor '{}'", printable(content.tensors.begin()->first));
  }
  require_variance(path, "observation.variance", file.scales.variance);
  require_variance(path, "estimate.variance", estimate_variance);
  std::ranges::copy(estimate_mean, file.spec.estimate_mean.begin());
  std::ranges::copy(estimate_variance, file.spec.estimate_variance.begin());
  check_golden(path, file);
  return file;
}

/// Turns the rows of the actor's last layer.
template <typename Turn>
void turn_actor(const ParameterLayout& layout, const Turn& turn, std::vector<float>& parameters) {
  const LayerView& last = layout.actor().back();
  for (const auto& [offset, columns] :
       {std::pair{last.weight, last.inputs}, std::pair{last.bias, 1}}) {
    const auto begin = parameters.begin() + offset;
    const std::vector<float> from(begin, begin + std::ptrdiff_t{kNumJoints} * columns);
    turn(from.data(), static_cast<std::size_t>(columns), &*begin);
  }
}

}  // namespace

ParameterLayout model_layout(const learner::NetworkSizes& sizes) {
  learner::NetworkSizes without_critic = sizes;
  without_critic.critic = {};
  return {without_critic, 1};
}

void set_trained(const std::vector<float>& trained, const std::array<double, kNumLegs>& mode_gain,
                 StudyModelFile& file) {
  const ParameterLayout layout = model_layout(file.sizes);
  file.parameters.assign(static_cast<std::size_t>(layout.size()), 0.0f);
  std::copy_n(trained.begin(), end_of_policy(layout), file.parameters.begin());
  turn_actor(
      layout,
      [&](const float* from, std::size_t columns, float* to) {
        joints_from_modes(mode_gain, from, columns, to);
      },
      file.parameters);
}

void write_study_model(const std::string& path, StudyModelFile file) {
  make_golden(file);
  TensorFile content;
  content.metadata = write_spec(kFormat, file.spec, file.scales.clip);
  const ParameterLayout layout = model_layout(file.sizes);
  for (const learner::TensorView& view : layout.tensors()) {
    if (view.offset >= end_of_policy(layout)) continue;
    const auto begin = file.parameters.begin() + view.offset;
    content.tensors[view.name] = {
        shape_of(view), {begin, begin + static_cast<std::ptrdiff_t>(view.rows) * view.cols}};
  }
  std::vector<float> estimate_mean(file.spec.estimate_mean.begin(), file.spec.estimate_mean.end());
  std::vector<float> estimate_variance(file.spec.estimate_variance.begin(),
                                       file.spec.estimate_variance.end());
  for (const NamedTensor& tensor : other_tensors(file, estimate_mean, estimate_variance)) {
    content.tensors[tensor.name] = {tensor.shape, *tensor.values};
  }
  decode(path, content);
  write_safetensors(path, content);
}

StudyModelFile read_study_model(const std::string& path) {
  return decode(path, read_safetensors(path));
}

bool is_study_model(const std::string& path) {
  const TensorFile content = read_safetensors(path);
  const auto format = content.metadata.find("sandrunner.format");
  return format != content.metadata.end() && format->second == kFormat;
}

TaskNetwork read_task_network(const std::string& path,
                              const std::array<double, kNumLegs>& mode_gain) {
  const auto into_modes = [&](TaskNetwork network) {
    turn_actor(
        network.layout,
        [&](const float* from, std::size_t columns, float* to) {
          modes_from_joints(mode_gain, from, columns, to);
        },
        network.parameters);
    return network;
  };
  if (is_study_model(path)) {
    StudyModelFile file = read_study_model(path);
    return into_modes({file.spec, file.scales, model_layout(file.sizes), file.parameters});
  }
  const PolicyFile policy = read_policy_file(path);
  const NetworkParameters& p = policy.parameters;
  TaskNetwork network{policy.spec,
                      {p.observation_mean, p.observation_variance, p.observation_clip},
                      model_layout({}),
                      {}};
  network.parameters.assign(static_cast<std::size_t>(network.layout.size()), 0.0f);
  from_policy(p, network.layout, network.parameters);
  return into_modes(std::move(network));
}

void require_scales(const PolicySpec& spec, const ObservationScales& network,
                    const PolicySettings& task, const InputScales& task_scales) {
  const auto check = [&](const std::string& what, double is, double expected) {
    if (std::fabs(is - expected) <= 1e-4 * std::fabs(expected)) return;
    throw InputError(
        fmt::format("policy '{}': its {} is {:.6g}, expected {:.6g}, with which this trainer shows "
                    "and takes it",
                    spec.name, what, is, expected));
  };
  constexpr int kAngles = 9;
  for (int i = 0; i < kObservationSize; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double deviation = 1.0 / task_scales.inverse_deviation[i];
    check(fmt::format("variance of observation {}", i), network.variance[k], deviation * deviation);
    if (i >= kAngles && i < kAngles + kNumJoints) continue;
    check(fmt::format("mean of observation {}", i), network.mean[k], task_scales.mean[i]);
  }
  check("clip of observations", network.clip, task_scales.clip);
  check("action scale", spec.action_scale_rad, task.action_scale_rad);
  check("action clip", spec.action_clip, task.action_clip);
}

}  // namespace sandrunner::train
