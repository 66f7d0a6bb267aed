// SPDX-License-Identifier: BSD-3-Clause
#include "policy/spec_metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "policy/text.h"

namespace sandrunner {
namespace {

constexpr double kLargestInEnvelope = 100.0;  // m/s, m/s^2, ...: beyond any robot
constexpr std::string_view kProvenancePrefix = "provenance.";

/// Keys of the envelope in the metadata.
struct EnvelopeKey {
  const char* name;
  double CommandEnvelope::* value;
};
constexpr EnvelopeKey kEnvelopeKeys[] = {
    {"sandrunner.envelope.forward_mps", &CommandEnvelope::forward_mps},
    {"sandrunner.envelope.backward_mps", &CommandEnvelope::backward_mps},
    {"sandrunner.envelope.lateral_mps", &CommandEnvelope::lateral_mps},
    {"sandrunner.envelope.yaw_radps", &CommandEnvelope::yaw_radps},
    {"sandrunner.envelope.acceleration_mps2", &CommandEnvelope::acceleration_mps2},
    {"sandrunner.envelope.yaw_acceleration_radps2", &CommandEnvelope::yaw_acceleration_radps2}};

}  // namespace

std::string Metadata::text(const std::string& key) {
  auto node = values_.extract(key);
  if (node.empty()) fail_file(path_, "metadata key '{}' is missing", key);
  return node.mapped();
}

void Metadata::expect(const std::string& key, const std::string& expected) {
  const std::string found = text(key);
  if (found != expected) {
    fail_file(path_, "metadata '{}' is '{}', expected '{}'", key, printable(found, 120), expected);
  }
}

double Metadata::positive(const std::string& key) {
  const double value = parse(key, text(key));
  if (value <= 0.0) fail_file(path_, "metadata '{}' is {}, expected more than 0", key, value);
  return value;
}

double Metadata::not_negative(const std::string& key) {
  const double value = parse(key, text(key));
  if (value < 0.0) fail_file(path_, "metadata '{}' is {}, expected at least 0", key, value);
  return value;
}

double Metadata::from_zero_to(const std::string& key, double largest) {
  const double value = not_negative(key);
  if (value > largest) {
    fail_file(path_, "metadata '{}' is {}, expected at most {}", key, value, largest);
  }
  return value;
}

// One text for each joint, from a list with commas.
JointArray<std::string> Metadata::joint_texts(const std::string& key) {
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

int Metadata::integer(const std::string& key, int least, int most) {
  const double value = parse(key, text(key));
  if (value != std::floor(value) || value < least || value > most) {
    fail_file(path_, "metadata '{}' is {}, expected a whole number from {} to {}", key, value,
              least, most);
  }
  return static_cast<int>(value);
}

JointArray<std::string> Metadata::joint_names(const std::string& key) {
  JointArray<std::string> names = joint_texts(key);
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (name->empty() || std::find(names.begin(), name, *name) != name) {
      fail_file(path_, "metadata '{}' has the joint name '{}', expected {} different names", key,
                printable(*name), kNumJoints);
    }
  }
  return names;
}

JointArray<double> Metadata::joint_numbers(const std::string& key) {
  const JointArray<std::string> texts = joint_texts(key);
  JointArray<double> result;
  for (int j = 0; j < kNumJoints; ++j) result[j] = parse(key, texts[j]);
  return result;
}

JointArray<double> Metadata::one_or_joint_numbers(const std::string& key) {
  const auto found = values_.find(key);
  if (found == values_.end() || found->second.find(',') != std::string::npos) {
    return joint_numbers(key);
  }
  JointArray<double> all;
  all.fill(parse(key, text(key)));
  return all;
}

std::map<std::string, std::string> Metadata::provenance() {
  std::map<std::string, std::string> result;
  for (auto it = values_.lower_bound(std::string(kProvenancePrefix));
       it != values_.end() && it->first.starts_with(kProvenancePrefix); it = values_.erase(it)) {
    result[it->first.substr(kProvenancePrefix.size())] = it->second;
  }
  return result;
}

void Metadata::expect_empty() const {
  if (!values_.empty()) {
    fail_file(path_, "unknown metadata key '{}'", printable(values_.begin()->first));
  }
}

double Metadata::parse(const std::string& key, std::string_view text) const {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) {
    fail_file(path_, "metadata '{}' is '{}', expected a number", key, printable(text));
  }
  return value;
}

void read_spec(Metadata& values, PolicySpec& spec) {
  values.expect("sandrunner.control_hz", std::to_string(kControlHz));
  spec.name = values.text("sandrunner.name");
  spec.joint_names = values.joint_names("sandrunner.joint_names");
  spec.nominal_position_rad = values.joint_numbers("sandrunner.nominal_position_rad");
  spec.action_scale_rad = values.one_or_joint_numbers("sandrunner.action_scale_rad");
  for (const double scale : spec.action_scale_rad) {
    if (scale > 0.0) continue;
    fail_file(values.path(), "metadata 'sandrunner.action_scale_rad' is {}, expected more than 0",
              scale);
  }
  if (values.contains("sandrunner.action_clip")) {
    spec.action_clip = values.not_negative("sandrunner.action_clip");
  }
  spec.kp_nmprad = values.not_negative("sandrunner.kp_nmprad");
  spec.kd_nmsprad = values.not_negative("sandrunner.kd_nmsprad");
  spec.torque_limit_nm = values.positive("sandrunner.torque_limit_nm");
  spec.yaw_command_clip_mps2 = values.positive("sandrunner.yaw_command_clip_mps2");
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

std::map<std::string, std::string> spec_metadata(const PolicySpec& spec) {
  // fmt writes the shortest text that reads back as the same number.
  const auto text = [](auto value) { return fmt::format("{}", value); };
  const JointArray<double>& scale = spec.action_scale_rad;
  const bool one = has_one_scale(spec);
  std::map<std::string, std::string> metadata = {
      {"sandrunner.name", spec.name},
      {"sandrunner.joint_names", joined(spec.joint_names, ",")},
      {"sandrunner.control_hz", text(kControlHz)},
      {"sandrunner.nominal_position_rad", joined(spec.nominal_position_rad, ",")},
      {"sandrunner.action_scale_rad", one ? text(scale[0]) : joined(scale, ",")},
      {"sandrunner.action_clip", text(spec.action_clip)},
      {"sandrunner.kp_nmprad", text(spec.kp_nmprad)},
      {"sandrunner.kd_nmsprad", text(spec.kd_nmsprad)},
      {"sandrunner.torque_limit_nm", text(spec.torque_limit_nm)},
      {"sandrunner.yaw_command_clip_mps2", text(spec.yaw_command_clip_mps2)}};
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

void set_in_metadata(std::map<std::string, std::string>& metadata, const std::string& assignment) {
  const std::size_t equals = std::min(assignment.find('='), assignment.size());
  const auto found = metadata.find("sandrunner." + assignment.substr(0, equals));
  if (found == metadata.end() || equals == assignment.size()) {
    throw InputError(
        fmt::format("--set: found '{}', expected KEY=VALUE with a key of policy/README.md, such as "
                    "action_scale_rad",
                    printable(assignment)));
  }
  found->second = assignment.substr(equals + 1);
}

}  // namespace sandrunner
