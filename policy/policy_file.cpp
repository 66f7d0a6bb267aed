// SPDX-License-Identifier: BSD-3-Clause
#include "policy/policy_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "policy/embedded.h"
#include "policy/perceptron_file.h"
#include "policy/safetensors.h"
#include "policy/spec_metadata.h"
#include "policy/text.h"

namespace sandrunner {
namespace {

constexpr const char* kEncoderKey = "sandrunner.encoder";
constexpr const char* kActorKey = "sandrunner.actor";
constexpr double kLargestObservationClip = 1e6;

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
void take_content(const std::string& path, std::map<std::string, Tensor> tensors, bool with_golden,
                  PolicyFile& file) {
  OtherTensors others;
  take_tensors(path, tensors_of(file.parameters), tensors);
  take_tensors(path, others.list(), tensors);
  if (with_golden) {
    take_tensors(path, golden_tensors(file.parameters.wiring, file.golden), tensors);
  }
  expect_no_tensors(path, tensors);
  check_variance(path, "observation.variance", file.parameters.observation_variance);
  check_variance(path, "estimate.variance", others.estimate_variance);
  std::copy_n(others.estimate_mean.begin(), kEstimateSize, file.spec.estimate_mean.begin());
  std::copy_n(others.estimate_variance.begin(), kEstimateSize, file.spec.estimate_variance.begin());
}

/// All but the wiring.
void read_settings(Metadata& values, PolicyFile& file) {
  values.expect(kFormatKey, kFormatVersion);
  values.expect(kRateKey, std::to_string(kPolicyHz));
  read_spec(values, file.spec);
  const double clip = values.positive(kClipKey);
  if (clip > kLargestObservationClip) {
    fail_file(values.path(), "metadata '{}' is {}, expected at most {}", kClipKey, clip,
              kLargestObservationClip);
  }
  file.parameters.observation_clip = static_cast<float>(clip);
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
  if (!content.metadata.contains(kFormatKey)) {
    fail_file(path,
              "not a policy file: metadata key 'sandrunner.format' is missing "
              "('sandrunner-policy import' takes bare weights)");
  }
  if (is_perceptron(content)) {
    fail_file(path,
              "found a perceptron with an observation of its own, expected a network as those "
              "that are trained here: it can run, but not be trained on");
  }
  PolicyFile file;
  Metadata values(path, std::move(content.metadata));
  read_settings(values, file);
  file.parameters.wiring = read_wiring(values, path);
  values.expect_empty();
  take_content(path, std::move(content.tensors), true, file);
  check_golden_example(path, file.parameters, file.golden);
  return file;
}

Policy make_policy(const std::string& path, TensorFile content) {
  if (is_perceptron(content)) return make_policy(decode_perceptron(path, std::move(content)));
  PolicyFile file = decode(path, std::move(content));
  const Wiring& wiring = file.parameters.wiring;
  if (wiring.sees_insight()) {
    fail_file(path, "found a network that needs what no robot can sense ({}), expected a policy",
              wiring_text(wiring));
  }
  return {std::move(file.spec), Network(file.parameters)};
}

std::map<std::string, std::string> metadata_of(const PolicyFile& file) {
  std::map<std::string, std::string> metadata = spec_metadata(file.spec);
  metadata[kFormatKey] = kFormatVersion;
  metadata[kRateKey] = fmt::format("{}", kPolicyHz);
  metadata[kClipKey] = fmt::format("{}", file.parameters.observation_clip);
  const Wiring& wiring = file.parameters.wiring;
  if (!(wiring == Wiring{})) {
    metadata[kEncoderKey] = encoder_text(wiring.encoder);
    metadata[kActorKey] = actor_inputs_text(wiring.actor_sees);
  }
  return metadata;
}

}  // namespace

void require_joints(const PolicySpec& spec, const RobotDescription& robot) {
  for (int j = 0; j < kNumJoints; ++j) {
    if (spec.joint_names[j] == robot.joint_names[j]) continue;
    throw InputError(fmt::format(
        "policy '{}' is for another robot: found joint {} '{}', expected '{}' of robot '{}'; train "
        "one with sandrunner-train --robot FILE, or let it only stand with --policy none",
        printable(spec.name), j + 1, printable(spec.joint_names[j]), robot.joint_names[j],
        robot.name));
  }
}

PolicyFile read_policy_file(const std::string& path) {
  return decode(path, read_safetensors(path));
}

PolicyFile parse_policy_file(std::string_view content, const std::string& name) {
  return decode(name, parse_safetensors(content, name));
}

Policy load_policy(const std::string& path) { return make_policy(path, read_safetensors(path)); }

Policy load_policy_text(std::string_view content, const std::string& name) {
  return make_policy(name, parse_safetensors(content, name));
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
    put_tensors(path, list, content);
  }
  decode(path, content);
  write_safetensors(path, content);
}

void set_in_spec(PolicyFile& file, const std::string& assignment) {
  std::map<std::string, std::string> metadata = metadata_of(file);
  set_in_metadata(metadata, assignment);
  const std::string origin = "--set " + assignment;
  Metadata values(origin, std::move(metadata));
  read_settings(values, file);
}

PolicyFile read_bare_weights(const std::string& path) {
  TensorFile content = read_safetensors(path);
  PolicyFile file;
  take_content(path, std::move(content.tensors), false, file);
  file.spec.provenance = std::move(content.metadata);
  return file;
}

}  // namespace sandrunner
