// SPDX-License-Identifier: BSD-3-Clause
// Between claims.cpp and the files with the rules of its claims.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "tools/study/evidence/evidence.h"

namespace sandrunner::study {

struct Outcome {
  bool agrees = false, contradicts = false;
  std::string ours = {};  ///< our figures
};

/// What a rule sees of the evidence. Remembers comparisons that rest on too few pairs of runs.
class Case {
 public:
  explicit Case(const Evidence& evidence) : evidence_(evidence) {}

  const Evidence& evidence() const { return evidence_; }
  bool above(const Figure& a, const Figure& b) { return check(study::above(a, b)); }
  bool above_by_share(const Figure& a, const Figure& b, double share) {
    return check(study::above_by_share(a, b, share));
  }
  bool below_by_share(const Figure& a, const Figure& b, double share) {
    return check(study::below_by_share(a, b, share));
  }
  /// "excess x": agrees or contradicts, by `a` over `b`, which are in this unit.
  Outcome excess(const Figure& a, const Figure& b, double x, const char* unit = "m/s");
  /// There is nothing that could be compared.
  void set_too_few() { too_few_ = true; }
  bool too_few() const { return too_few_; }

  /// A figure of runs on a ground in E1 ("beach") or E3, at commands from `low` to `high`.
  template <typename Of>
  Figure straight(const std::string& controller, const std::string& ground, double low, double high,
                  Of of) const {
    return evidence_.figure(ground == "beach" ? "E1" : "E3", controller, [&](const Measured& m) {
      return of(between(m.select(ground), low, high));
    });
  }
  Figure success(const std::string& controller, const std::string& ground, double low,
                 double high) const;
  /// Mean of successful runs.
  Figure mean(const std::string& controller, const std::string& ground, double low, double high,
              const std::string& name) const;
  /// Greatest end speed over all commands.
  Figure top_speed(const std::string& controller, const std::string& ground) const;
  /// Mean of both ways' runs in the groups of turns.
  Figure turn(const std::string& experiment, const std::string& controller,
              const std::string& ground, double rate_radps, const std::string& name) const;
  /// Whether two controllers both have eight successes at a command.
  bool both_succeed(const std::string& a, const std::string& b, const std::string& ground,
                    double command) const;

 private:
  bool check(const Comparison& comparison) {
    too_few_ = too_few_ || comparison.pairs < kLeastPairs;
    return comparison.holds;
  }
  const Evidence& evidence_;
  bool too_few_ = false;
};

struct ClaimRule {
  const char* id;
  std::vector<const char*> experiments;
  std::vector<const char*> controllers;
  Outcome (*judge)(Case& c);
};

const std::vector<ClaimRule>& beach_rules();
const std::vector<ClaimRule>& ground_rules();
const std::vector<ClaimRule>& grid_rules();
const std::vector<ClaimRule>& attribution_rules();

}  // namespace sandrunner::study
