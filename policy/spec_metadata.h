// SPDX-License-Identifier: BSD-3-Clause
// The metadata of a policy file: text by key, and the part of it that says how a policy runs.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "policy/policy.h"

namespace sandrunner {

inline constexpr const char* kFormatKey = "sandrunner.format";
inline constexpr const char* kFormatVersion = "1";
inline constexpr const char* kRateKey = "sandrunner.policy_hz";
inline constexpr const char* kClipKey = "sandrunner.observation_clip";

/// Takes the keys out of the metadata one by one; what is left at the end is unknown. All throw
/// InputError, which names file and key.
class Metadata {
 public:
  Metadata(std::string path, std::map<std::string, std::string> values)
      : path_(std::move(path)), values_(std::move(values)) {}

  const std::string& path() const { return path_; }
  bool contains(const std::string& key) const { return values_.contains(key); }
  std::string text(const std::string& key);
  void expect(const std::string& key, const std::string& expected);
  double positive(const std::string& key);
  double not_negative(const std::string& key);
  double from_zero_to(const std::string& key, double largest);
  /// A whole number in [least, most].
  int integer(const std::string& key, int least, int most);
  /// Twelve different names with commas between.
  JointArray<std::string> joint_names(const std::string& key);
  /// Twelve numbers with commas between.
  JointArray<double> joint_numbers(const std::string& key);
  /// The same, or one that counts for all joints.
  JointArray<double> one_or_joint_numbers(const std::string& key);
  /// All texts under free keys.
  std::map<std::string, std::string> provenance();
  void expect_empty() const;

 private:
  JointArray<std::string> joint_texts(const std::string& key);
  double parse(const std::string& key, std::string_view text) const;

  std::string path_;
  std::map<std::string, std::string> values_;
};

/// What the metadata says besides the network and its rate; leaves the estimate's scales alone.
void read_spec(Metadata& values, PolicySpec& spec);
/// The way back.
std::map<std::string, std::string> spec_metadata(const PolicySpec& spec);
/// Changes a value that is there: "KEY=VALUE", the key without "sandrunner.". Throws InputError.
void set_in_metadata(std::map<std::string, std::string>& metadata, const std::string& assignment);

}  // namespace sandrunner
