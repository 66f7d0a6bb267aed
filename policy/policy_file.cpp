// SPDX-License-Identifier: BSD-3-Clause
#include "policy/policy_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "policy/embedded.h"
#include "policy/safetensors.h"
#include "policy/study_file.h"
#include "policy/text.h"

namespace sandrunner {
namespace {

constexpr const char* kFormatVersion = "1";
constexpr const char* kEncoderKey = "sandrunner.encoder";
constexpr const char* kActorKey = "sandrunner.actor";
constexpr double kLargestObservationClip = 1e6;
constexpr double kLargestInEnvelope = 100.0;  // m/s, m/s^2, ...: beyond any robot
constexpr std::string_view kProvenancePrefix = "provenance.";

/// Keys of the envelope in the metadata.
struct EnvelopeKey {
  const char* name;
  double CommandEnvelope::*value;
};
constexpr EnvelopeKey kEnvelopeKeys[] = {
    {"sandrunner.envelope.forward_mps", &CommandEnvelope::forward_mps},
    {"sandrunner.envelope.backward_mps", &CommandEnvelope::backward_mps},
    {"sandrunner.envelope.lateral_mps", &CommandEnvelope::lateral_mps},
    {"sandrunner.envelope.yaw_radps", &CommandEnvelope::yaw_radps},
    {"sandrunner.envelope.acceleration_mps2", &CommandEnvelope::acceleration_mps2},
    {"sandrunner.envelope.yaw_acceleration_radps2", &CommandEnvelope::yaw_acceleration_radps2}};

/// Takes the keys out of the metadata one by one; what is left at the end is unknown.
class Metadata {
 public:
  Metadata(const std::string& path, std::map<std::string, std::string> values)
      : path_(path), values_(std::move(values)) {}

  std::string text(const std::string& key) {
    auto node = values_.extract(key);
    if (node.empty()) fail_file(path_, "metadata key '{}' is missing", key);
    return node.mapped();
  }

  void expect(const std::string& key, const std::string& expected) {
    const std::string found = text(key);
    if (found != expected) {
      fail_file(path_, "metadata '{}' is '{}', expected '{}'", key, printable(found, 120),
                expected);
    }
  }

  double positive(const std::string& key) {
    const double value = parse(key, text(key));
    if (value <= 0.0) fail_file(path_, "metadata '{}' is {}, expected more than 0", key, value);
    return value;
  }

  double not_negative(const std::string& key) {
    const double value = parse(key, text(key));
    if (value < 0.0) fail_file(path_, "metadata '{}' is {}, expected at least 0", key, value);
    return value;
  }

  double from_zero_to(const std::string& key, double largest) {
    const double value = not_negative(key);
    if (value > largest) {
      fail_file(path_, "metadata '{}' is {}, expected at most {}", key, value, largest);
    }
    return value;
  }

  bool contains(const std::string& key) const { return values_.contains(key); }

  /// One text for each joint, from a list with commas.
  JointArray<std::string> joint_texts(const std::string& key) {
    const std::string list = text(key);
    const auto count = std::count(list.begin(), list.end(), ',') + 1;
    if (count != kNumJoints) {
      fail_file(path_, "metadata '{}' has {} values, expected {}", key, count, kNumJoints);
    }
    JointArray<std::string> result;
    std::size_t begin = 0;
    for (std::string& value : result) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      value = list.substr(begin, end - begin);
      begin = end + 1;
    }
    return result;
  }

  JointArray<std::string> joint_names(const std::string& key) {
    JointArray<std::string> names = joint_texts(key);
    for (auto name = names.begin(); name != names.end(); ++name) {
      if (name->empty() || std::find(names.begin(), name, *name) != name) {
        fail_file(path_, "metadata '{}' has the joint name '{}', expected {} different names", key,
                  printable(*name), kNumJoints);
      }
    }
    return names;
  }

  JointArray<double> joint_numbers(const std::string& key) {
    const JointArray<std::string> texts = joint_texts(key);
    JointArray<double> result;
    for (int j = 0; j < kNumJoints; ++j) result[j] = parse(key, texts[j]);
    return result;
  }

  std::map<std::string, std::string> provenance() {
    std::map<std::string, std::string> result;
    for (auto it = values_.lower_bound(std::string(kProvenancePrefix));
         it != values_.end() && it->first.starts_with(kProvenancePrefix); it = values_.erase(it)) {
      result[it->first.substr(kProvenancePrefix.size())] = it->second;
    }
    return result;
  }

  void expect_empty() const {
    if (!values_.empty()) {
      fail_file(path_, "unknown metadata key '{}'", printable(values_.begin()->first));
    }
  }

 private:
  double parse(const std::string& key, std::string_view text) const {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) {
      fail_file(path_, "metadata '{}' is '{}', expected a number", key, printable(text));
    }
    return value;
  }

  const std::string& path_;
  std::map<std::string, std::string> values_;
};

/// The tensors of a file besides the network's, with `estimate_*` as vectors while they are read or
/// written.
struct OtherTensors {
  std::vector<float> estimate_mean;
  std::vector<float> estimate_variance;

  std::vector<NamedTensor> list() {
    return {{"estimate.mean", {kEstimateSize}, &estimate_mean},
            {"estimate.variance", {kEstimateSize}, &estimate_variance}};
  }
};

std::vector<NamedTensor> golden_tensors(const Wiring& wiring, GoldenExample& golden) {
  std::vector<NamedTensor> tensors = {
      {"golden.observation", {kGoldenSteps, kObservationSize}, &golden.observation},
      {"golden.action", {kGoldenSteps, kNumJoints}, &golden.action},
      {"golden.estimate", {kGoldenSteps, kEstimateSize}, &golden.estimate_raw}};
  if (wiring.sees_insight()) {
    tensors.push_back({"golden.insight", {kGoldenSteps, kInsightSize}, &golden.insight});
  }
  return tensors;
}

/// Moves each of `wanted` out of `tensors`.
void take(const std::string& path, const std::vector<NamedTensor>& wanted,
          std::map<std::string, Tensor>& tensors) {
  for (const NamedTensor& want : wanted) {
    auto node = tensors.extract(want.name);
    if (node.empty()) fail_file(path, "tensor '{}' is missing", want.name);
    if (node.mapped().shape != want.shape) {
      fail_file(path, "tensor '{}' has shape [{}], expected [{}]", want.name,
                printable(joined(node.mapped().shape, ", ")), joined(want.shape, ", "));
    }
    *want.values = std::move(node.mapped().values);
  }
}

void check_variance(const std::string& path, const std::string& name,
                    const std::vector<float>& variance) {
  const auto bad = std::find_if(variance.begin(), variance.end(), [](float v) { return v < 0.0f; });
  if (bad != variance.end()) {
    fail_file(path, "tensor '{}': value {} is {}, expected at least 0", name,
              bad - variance.begin(), *bad);
  }
}

/// Network, normalisation and, if wanted, golden example out of `tensors`, which must hold nothing
/// else.
void take_tensors(const std::string& path, std::map<std::string, Tensor> tensors, bool with_golden,
                  PolicyFile& file) {
  OtherTensors others;
  take(path, tensors_of(file.parameters), tensors);
  take(path, others.list(), tensors);
  if (with_golden) take(path, golden_tensors(file.parameters.wiring, file.golden), tensors);
  if (!tensors.empty()) {
    fail_file(path, "unknown tensor '{}'", printable(tensors.begin()->first));
  }
  check_variance(path, "observation.variance", file.parameters.observation_variance);
  check_variance(path, "estimate.variance", others.estimate_variance);
  std::copy_n(others.estimate_mean.begin(), kEstimateSize, file.spec.estimate_mean.begin());
  std::copy_n(others.estimate_variance.begin(), kEstimateSize, file.spec.estimate_variance.begin());
}

void read_spec(Metadata& values, const std::string& path, PolicyFile& file) {
  values.expect("sandrunner.format", kFormatVersion);
  values.expect("sandrunner.policy_hz", std::to_string(kPolicyHz));
  values.expect("sandrunner.control_hz", std::to_string(kControlHz));
  PolicySpec& spec = file.spec;
  spec.name = values.text("sandrunner.name");
  spec.joint_names = values.joint_names("sandrunner.joint_names");
  spec.nominal_position_rad = values.joint_numbers("sandrunner.nominal_position_rad");
  spec.action_scale_rad = values.positive("sandrunner.action_scale_rad");
  if (values.contains("sandrunner.action_clip")) {
    spec.action_clip = values.not_negative("sandrunner.action_clip");
  }
  spec.kp_nmprad = values.not_negative("sandrunner.kp_nmprad");
  spec.kd_nmsprad = values.not_negative("sandrunner.kd_nmsprad");
  spec.torque_limit_nm = values.positive("sandrunner.torque_limit_nm");
  spec.yaw_command_clip_mps2 = values.positive("sandrunner.yaw_command_clip_mps2");
  const double clip = values.positive("sandrunner.observation_clip");
  if (clip > kLargestObservationClip) {
    fail_file(path, "metadata 'sandrunner.observation_clip' is {}, expected at most {}", clip,
              kLargestObservationClip);
  }
  file.parameters.observation_clip = static_cast<float>(clip);
  spec.has_envelope =
      std::any_of(std::begin(kEnvelopeKeys), std::end(kEnvelopeKeys),
                  [&](const EnvelopeKey& key) { return values.contains(key.name); });
  if (spec.has_envelope) {
    for (const EnvelopeKey& key : kEnvelopeKeys) {
      spec.envelope.*key.value = values.from_zero_to(key.name, kLargestInEnvelope);
    }
  }
  spec.provenance = values.provenance();
}

Wiring read_wiring(Metadata& values, const std::string& path) {
  const auto key = [&](const char* name) { return fmt::format("'{}': metadata '{}'", path, name); };
  Wiring wiring;
  if (values.contains(kEncoderKey)) {
    wiring.encoder = parse_encoder(key(kEncoderKey), values.text(kEncoderKey));
  }
  if (values.contains(kActorKey)) {
    wiring.actor_sees = parse_actor_inputs(key(kActorKey), values.text(kActorKey));
  }
  return wiring;
}

PolicyFile decode(const std::string& path, TensorFile content) {
  if (!content.metadata.contains("sandrunner.format")) {
    fail_file(path,
              "not a policy file: metadata key 'sandrunner.format' is missing "
              "('sandrunner-policy import' takes bare weights)");
  }
  renew_study_file(path, content);
  PolicyFile file;
  Metadata values(path, std::move(content.metadata));
  read_spec(values, path, file);
  file.parameters.wiring = read_wiring(values, path);
  values.expect_empty();
  take_tensors(path, std::move(content.tensors), true, file);
  check_golden_example(path, file.parameters, file.golden);
  return file;
}

Policy make_policy(const std::string& path, PolicyFile file) {
  const Wiring& wiring = file.parameters.wiring;
  if (wiring.sees_insight()) {
    fail_file(path, "found a network that needs what no robot can sense ({}), expected a policy",
              wiring_text(wiring));
  }
  return {std::move(file.spec), Network(file.parameters)};
}

std::map<std::string, std::string> metadata_of(const PolicyFile& file) {
  // fmt writes the shortest text that reads back as the same number.
  const auto text = [](auto value) { return fmt::format("{}", value); };
  const PolicySpec& spec = file.spec;
  std::map<std::string, std::string> metadata = {
      {"sandrunner.format", kFormatVersion},
      {"sandrunner.name", spec.name},
      {"sandrunner.joint_names", joined(spec.joint_names, ",")},
      {"sandrunner.policy_hz", text(kPolicyHz)},
      {"sandrunner.control_hz", text(kControlHz)},
      {"sandrunner.nominal_position_rad", joined(spec.nominal_position_rad, ",")},
      {"sandrunner.action_scale_rad", text(spec.action_scale_rad)},
      {"sandrunner.action_clip", text(spec.action_clip)},
      {"sandrunner.kp_nmprad", text(spec.kp_nmprad)},
      {"sandrunner.kd_nmsprad", text(spec.kd_nmsprad)},
      {"sandrunner.torque_limit_nm", text(spec.torque_limit_nm)},
      {"sandrunner.yaw_command_clip_mps2", text(spec.yaw_command_clip_mps2)},
      {"sandrunner.observation_clip", text(file.parameters.observation_clip)}};
  const Wiring& wiring = file.parameters.wiring;
  if (!(wiring == Wiring{})) {
    metadata[kEncoderKey] = encoder_text(wiring.encoder);
    metadata[kActorKey] = actor_inputs_text(wiring.actor_sees);
  }
  if (spec.has_envelope) {
    for (const EnvelopeKey& key : kEnvelopeKeys) {
      metadata[key.name] = text(spec.envelope.*key.value);
    }
  }
  for (const auto& [key, value] : spec.provenance) {
    metadata[std::string(kProvenancePrefix).append(key)] = value;
  }
  return metadata;
}

}  // namespace

PolicyFile read_policy_file(const std::string& path) {
  return decode(path, read_safetensors(path));
}

PolicyFile parse_policy_file(std::string_view content, const std::string& name) {
  return decode(name, parse_safetensors(content, name));
}

Policy load_policy(const std::string& path) { return make_policy(path, read_policy_file(path)); }

Policy load_policy_text(std::string_view content, const std::string& name) {
  return make_policy(name, parse_policy_file(content, name));
}

std::string_view shipped_policy_text(const std::string& robot) {
  return embedded_policy_file(robot + ".safetensors");
}

Policy load_shipped_policy(const std::string& robot) {
  return load_policy_text(shipped_policy_text(robot), robot + ".safetensors (built in)");
}

void write_policy_file(const std::string& path, const PolicyFile& file) {
  PolicyFile copy = file;
  OtherTensors others{{file.spec.estimate_mean.begin(), file.spec.estimate_mean.end()},
                      {file.spec.estimate_variance.begin(), file.spec.estimate_variance.end()}};
  TensorFile content;
  content.metadata = metadata_of(file);
  for (const auto& list : {tensors_of(copy.parameters), others.list(),
                           golden_tensors(file.parameters.wiring, copy.golden)}) {
    for (const NamedTensor& tensor : list) {
      if (tensor.values->size() != tensor.size()) {
        fail_file(path, "tensor '{}' has {} values, expected {}", tensor.name,
                  tensor.values->size(), tensor.size());
      }
      content.tensors[tensor.name] = {tensor.shape, *tensor.values};
    }
  }
  decode(path, content);
  write_safetensors(path, content);
}

void set_in_spec(PolicyFile& file, const std::string& assignment) {
  std::map<std::string, std::string> metadata = metadata_of(file);
  const std::size_t equals = std::min(assignment.find('='), assignment.size());
  const auto found = metadata.find("sandrunner." + assignment.substr(0, equals));
  if (found == metadata.end() || equals == assignment.size()) {
    throw InputError(
        fmt::format("--set: found '{}', expected KEY=VALUE with a key of policy/README.md, such as "
                    "action_scale_rad",
                    printable(assignment)));
  }
  found->second = assignment.substr(equals + 1);
  const std::string origin = "--set " + assignment;
  Metadata values(origin, std::move(metadata));
  read_spec(values, origin, file);
}

PolicyFile read_bare_weights(const std::string& path) {
  TensorFile content = read_safetensors(path);
  PolicyFile file;
  take_tensors(path, std::move(content.tensors), false, file);
  file.spec.provenance = std::move(content.metadata);
  return file;
}

}  // namespace sandrunner
