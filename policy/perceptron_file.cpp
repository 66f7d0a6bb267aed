// SPDX-License-Identifier: BSD-3-Clause
#include "policy/perceptron_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <sstream>
#include <utility>

#include "policy/golden.h"
#include "policy/names.h"
#include "policy/spec_metadata.h"
#include "policy/text.h"

namespace sandrunner {
namespace {

constexpr const char* kNetworkKey = "sandrunner.network";
constexpr const char* kJointsKey = "sandrunner.network_joints";
constexpr const char* kTermsKey = "sandrunner.observation";
constexpr const char* kHistoryKey = "sandrunner.history";
constexpr const char* kOrderKey = "sandrunner.history_order";
constexpr const char* kActivationKey = "sandrunner.activation";
constexpr const char* kActorLayersKey = "sandrunner.actor_layers";
constexpr const char* kEstimatorKey = "sandrunner.estimator_layers";
constexpr const char* kVelocityKey = "sandrunner.estimator_velocity_scale";
constexpr int kMostHistory = 100;
constexpr double kLargest = 1e6;

constexpr Named<Activation> kActivations[] = {{Activation::kElu, "elu"},
                                              {Activation::kRelu, "relu"},
                                              {Activation::kLeakyRelu, "leaky_relu"},
                                              {Activation::kTanh, "tanh"}};

/// Whole numbers with commas between; none: an empty text.
std::vector<int> widths_of(Metadata& values, const char* key) {
  const std::string text = values.text(key);
  std::vector<int> widths;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    int width = 0;
    const char* const end = word.data() + word.size();
    const auto result = std::from_chars(word.data(), end, width);
    if (result.ec != std::errc() || result.ptr != end) {
      fail_file(values.path(), "metadata '{}' is '{}', expected widths with commas between", key,
                printable(text));
    }
    widths.push_back(width);
  }
  return widths;
}

JointArray<int> joints_of(Metadata& values, const PolicySpec& spec) {
  const JointArray<std::string> names = values.joint_names(kJointsKey);
  JointArray<int> joint_of{};
  for (int j = 0; j < kNumJoints; ++j) {
    const auto found = std::ranges::find(spec.joint_names, names[j]);
    if (found == spec.joint_names.end()) {
      fail_file(values.path(), "metadata '{}' has '{}', expected the robot's joints: {}",
                kJointsKey, printable(names[j]), printable(joined(spec.joint_names, ", "), 300));
    }
    joint_of[j] = static_cast<int>(found - spec.joint_names.begin());
  }
  return joint_of;
}

PerceptronParameters read_parameters(Metadata& values, const PolicySpec& spec) {
  const auto where = [&](const char* key) {
    return fmt::format("'{}': metadata '{}'", values.path(), key);
  };
  PerceptronParameters p;
  p.policy_hz = values.integer(kRateKey, 1, kPolicyHz);
  if (kPolicyHz % p.policy_hz != 0) {
    fail_file(values.path(), "metadata '{}' is {}, expected a divisor of {}", kRateKey, p.policy_hz,
              kPolicyHz);
  }
  p.joint_of = joints_of(values, spec);
  ObservationLayout& layout = p.observation;
  layout.terms = parse_terms(where(kTermsKey), values.text(kTermsKey));
  layout.clip = values.from_zero_to(kClipKey, kLargest);
  layout.history = values.integer(kHistoryKey, 1, kMostHistory);
  layout.order = parse_history_order(where(kOrderKey), values.text(kOrderKey));
  p.activation = parse_activation(where(kActivationKey), values.text(kActivationKey));
  p.actor = widths_of(values, kActorLayersKey);
  p.estimator = widths_of(values, kEstimatorKey);
  p.velocity_scale = values.from_zero_to(kVelocityKey, kLargest);
  if (p.velocity_scale < 1.0 / kLargest) {
    fail_file(values.path(), "metadata '{}' is {}, expected at least {}", kVelocityKey,
              p.velocity_scale, 1.0 / kLargest);
  }
  return p;
}

std::vector<NamedTensor> all_tensors(const std::string& path, PerceptronFile& file) {
  std::vector<NamedTensor> tensors = tensors_of("'" + path + "'", file.parameters);
  const auto inputs = static_cast<std::size_t>(file.parameters.observation.inputs());
  tensors.push_back({"golden.observation", {kGoldenSteps, inputs}, &file.golden_observation});
  tensors.push_back({"golden.action", {kGoldenSteps, kNumJoints}, &file.golden_action});
  return tensors;
}

}  // namespace

Activation parse_activation(const std::string& where, const std::string& text) {
  return value_named(kActivations, where, text);
}

std::string activation_text(Activation activation) { return name_of(kActivations, activation); }

std::vector<NamedTensor> tensors_of(const std::string& where, PerceptronParameters& parameters) {
  using P = PerceptronParameters;
  std::vector<NamedTensor> tensors;
  const auto add = [&](const char* part, int inputs, std::vector<int> widths,
                       std::vector<DenseParameters>& layers) {
    if (std::ssize(widths) > P::kMostHidden + 1) {
      throw InputError(fmt::format("{}: {} has {} hidden layers, expected at most {}", where, part,
                                   widths.size() - 1, P::kMostHidden));
    }
    layers.resize(widths.size());
    for (std::size_t k = 0; k < widths.size(); ++k) {
      if (widths[k] < 1 || widths[k] > P::kWidest) {
        throw InputError(fmt::format("{}: {} has a layer of {} units, expected 1 to {}", where,
                                     part, widths[k], P::kWidest));
      }
      add_layer(fmt::format("{}.{}", part, k), inputs, widths[k], layers[k], tensors);
      inputs = widths[k];
    }
  };
  const ObservationLayout& layout = parameters.observation;
  if (layout.inputs() > ObservationLayout::kMostInputs) {
    throw InputError(fmt::format("{}: {} observations of {} numbers, expected at most {} numbers",
                                 where, layout.history, layout.numbers(),
                                 ObservationLayout::kMostInputs));
  }
  if (!parameters.estimator.empty()) {
    if (parameters.estimator.back() <= P::kVelocitySize) {
      throw InputError(
          fmt::format("{}: the estimator has {} outputs, expected a velocity (3) and "
                      "a latent",
                      where, parameters.estimator.back()));
    }
    if (layout.history > 1 && layout.order != HistoryOrder::kNewestFirst) {
      throw InputError(fmt::format("{}: found an estimator and a history {}, expected newest_first",
                                   where, history_order_text(layout.order)));
    }
    add("estimator", layout.inputs(), parameters.estimator, parameters.estimator_layers);
  }
  std::vector<int> widths = parameters.actor;
  widths.push_back(kNumJoints);
  add("actor", parameters.actor_inputs(), widths, parameters.actor_layers);
  return tensors;
}

bool is_perceptron(const TensorFile& content) { return content.metadata.contains(kNetworkKey); }

PerceptronFile decode_perceptron(const std::string& path, TensorFile content) {
  PerceptronFile file;
  Metadata values(path, std::move(content.metadata));
  values.expect(kFormatKey, kFormatVersion);
  values.expect(kNetworkKey, "perceptron");
  read_spec(values, file.spec);
  file.parameters = read_parameters(values, file.spec);
  values.expect_empty();
  take_tensors(path, all_tensors(path, file), content.tensors);
  expect_no_tensors(path, content.tensors);
  check_golden_example(path, file);
  return file;
}

TensorFile encode_perceptron(const std::string& path, const PerceptronFile& file) {
  PerceptronFile copy = file;
  const PerceptronParameters& p = file.parameters;
  JointArray<std::string> names;
  for (int j = 0; j < kNumJoints; ++j) names[j] = file.spec.joint_names[p.joint_of[j]];
  const auto text = [](auto value) { return fmt::format("{}", value); };
  TensorFile content{spec_metadata(file.spec), {}};
  content.metadata.insert({{kFormatKey, kFormatVersion},
                           {kNetworkKey, "perceptron"},
                           {kRateKey, text(p.policy_hz)},
                           {kJointsKey, joined(names, ",")},
                           {kTermsKey, terms_text(p.observation.terms)},
                           {kClipKey, text(p.observation.clip)},
                           {kHistoryKey, text(p.observation.history)},
                           {kOrderKey, history_order_text(p.observation.order)},
                           {kActivationKey, activation_text(p.activation)},
                           {kActorLayersKey, joined(p.actor, ",")},
                           {kEstimatorKey, joined(p.estimator, ",")},
                           {kVelocityKey, text(p.velocity_scale)}});
  put_tensors(path, all_tensors(path, copy), content);
  decode_perceptron(path, content);
  return content;
}

void take_bare_tensors(const std::string& path, TensorFile content, PerceptronFile& file) {
  // The widths are those of the weights, as many as there are.
  const auto widths_in = [&](const char* part) {
    std::vector<int> widths;
    for (int k = 0;; ++k) {
      const auto found = content.tensors.find(fmt::format("{}.{}.weight", part, k));
      if (found == content.tensors.end() || found->second.shape.empty()) return widths;
      widths.push_back(static_cast<int>(found->second.shape.front()));
    }
  };
  file.parameters.estimator = widths_in("estimator");
  file.parameters.actor = widths_in("actor");
  if (file.parameters.actor.empty()) fail_file(path, "tensor 'actor.0.weight' is missing");
  file.parameters.actor.pop_back();
  take_tensors(path, all_tensors(path, file), content.tensors);
  expect_no_tensors(path, content.tensors);
  file.spec.provenance = std::move(content.metadata);
}

double check_golden_example(const std::string& path, const PerceptronFile& file) {
  const Perceptron network(file.parameters, file.spec.nominal_position_rad, 0.0);
  const auto inputs = static_cast<std::size_t>(file.parameters.observation.inputs());
  double largest = 0.0;
  for (std::size_t k = 0; k < kGoldenSteps; ++k) {
    JointArray<float> action;
    std::array<float, 3> velocity;
    network.answer(&file.golden_observation[k * inputs], action, velocity);
    const auto step = static_cast<int>(k);
    largest = std::max(largest, golden_deviation(path, step, "action", action, file.golden_action));
  }
  return largest;
}

Policy make_policy(PerceptronFile file) {
  file.spec.estimate_mean.fill(0.0f);  // what it estimates, it says in physical units
  file.spec.estimate_variance.fill(1.0f);
  Perceptron network(file.parameters, file.spec.nominal_position_rad, file.spec.action_clip);
  return {std::move(file.spec), std::move(network)};
}

}  // namespace sandrunner
