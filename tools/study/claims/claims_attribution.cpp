// SPDX-License-Identifier: BSD-3-Clause
// The rules of CLAIMS.md for what the oracles' answers depend on.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "tools/study/claims/claim_rules.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/oracles.h"

namespace sandrunner::study {
namespace {

Figure ablation(const Case& c, const char* oracle, const char* group) {
  return oracle_ablation(c.evidence(), oracle, group);
}

Outcome estimate_matters_more(Case& c) {
  bool both = true, neither = true;
  std::string text;
  for (const char* oracle : oracle_controllers()) {
    const Figure times = ratio(ablation(c, oracle, "e"), ablation(c, oracle, "T"));
    both = both && median(times) >= 2.0;
    neither = neither && median(times) < 1.0;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", find_controller(oracle)->name,
                        printed(times, 1.0, 2));
  }
  return {both, neither, text + " times that of T"};
}

Outcome history_replaces_terrain(Case& c) {
  const Figure h = ablation(c, "oracle-h", "T"), o = ablation(c, "oracle-o", "T");
  return {c.above(o, h), c.above(h, o),
          fmt::format("Oracle(H) {}, Oracle(O) {}", printed(h, 1.0, 4), printed(o, 1.0, 4))};
}

Outcome depends_on_stiffness(Case& c) {
  const auto spread = [&](const char* oracle) {
    return c.evidence().figure("E8", oracle, [](const Measured& m) {
      const std::vector<double>& bins = m.select(kOracleGround).at(0)->lists.at("bin_T");
      return SeedValue{(greatest_of(bins) - least_of(bins)) / mean_of(bins)};
    });
  };
  const Figure h = spread("oracle-h"), o = spread("oracle-o");
  return {median(o) > 1.2 * median(h), median(o) < median(h),
          fmt::format("Oracle(H) {}, Oracle(O) {}", printed(h, 1.0, 2), printed(o, 1.0, 2))};
}

Outcome depth_matters_more_than_inertia(Case& c) {
  bool larger = true, smaller = true;
  std::string text;
  for (const OracleJoint& joint : kOracleJoints) {
    const auto gradient = [&](std::size_t parameter) {
      return oracle_value(c.evidence(), "oracle-o", joint.list, parameter);
    };
    const Figure flat = gradient(kSigmaFlat), cone = gradient(kSigmaCone);
    const Figure inertia = gradient(kInertia);
    const double least = std::min(median(flat), median(cone));
    const double greatest = std::max(median(flat), median(cone));
    larger = larger && least > median(inertia);
    smaller = smaller && greatest < median(inertia);
    text += fmt::format("{}{} {}, {} against {}", text.empty() ? "" : "; ", joint.name,
                        printed(flat, 1.0, 4), printed(cone, 1.0, 4), printed(inertia, 1.0, 4));
  }
  return {larger, smaller, text};
}

}  // namespace

const std::vector<ClaimRule>& attribution_rules() {
  static const std::vector<ClaimRule> kRules = {
      {"59", {"E8"}, oracle_controllers(), estimate_matters_more},
      {"63", {"E8"}, oracle_controllers(), history_replaces_terrain},
      {"64", {"E8"}, oracle_controllers(), depends_on_stiffness},
      {"65", {"E8"}, {"oracle-o"}, depth_matters_more_than_inertia},
  };
  return kRules;
}

}  // namespace sandrunner::study
