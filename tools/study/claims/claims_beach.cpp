// SPDX-License-Identifier: BSD-3-Clause
// The rules of CLAIMS.md, "Dry sand" and "All of it".
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "tools/study/claims/claim_rules.h"
#include "tools/study/claims/paper.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/experiments/lab.h"

namespace sandrunner::study {
namespace {

constexpr double kSlowest = 0.5, kFastest = 4.0;  // m/s, commands
constexpr const char* kSand = "beach";

const char* const kOthers[] = {"env-rigid", "env-quasistatic", "env-linear", "pl-gm", "pl-rigid"};

std::string percent(const Figure& share) { return printed(share, 100.0, 1) + " %"; }

Figure overall_success(const Case& c, const char* controller) {
  return c.success(controller, kSand, kSlowest, kFastest);
}

const paper::BeachRow& paper_row(std::string_view controller) {
  return *std::ranges::find(paper::kBeach, controller, &paper::BeachRow::controller);
}

// Against the success rate that the paper prints.
Outcome success(const Case& c, const char* controller) {
  const Figure share = overall_success(c, controller);
  const double x = paper_row(controller).success;
  return {is_share(share, x), is_far_from_share(share, x), percent(share)};
}

Outcome top_speed(Case& c) {
  const Figure top = c.top_speed("ours", kSand);
  const double x = paper_row("ours").top_mps;
  return {is_about(top, x), is_far_from(top, x), printed(top, 1.0, 2) + " m/s"};
}

Outcome sinking(Case& c) {
  const Figure depth = c.straight("ours", kSand, 2.5, 3.5,
                                  [](const auto& groups) { return mean_value(groups, "depth_m"); });
  return {median(depth) >= 0.059, median(depth) < 0.040, printed(depth, 1e3, 1) + " mm"};
}

Outcome no_failure(Case& c) {
  const Figure share = overall_success(c, "ours");
  bool every_seed = true;
  for (const auto& [seed, value] : share) every_seed = every_seed && value.value >= 0.97;
  return {every_seed, median(share) < 0.90, percent(share)};
}

Outcome pl_rigid_success(Case& c) { return success(c, "pl-rigid"); }

Outcome pl_rigid_bell(Case& c) {
  const double slow = median(c.success("pl-rigid", kSand, 0.5, 1.5));
  const double middle = median(c.success("pl-rigid", kSand, 2.0, 2.5));
  const double fast = median(c.success("pl-rigid", kSand, 3.0, 4.0));
  return {middle - slow >= 0.25 && middle - fast >= 0.25, middle <= slow && middle <= fast,
          fmt::format("{:.0f}, {:.0f}, {:.0f} %", 100 * slow, 100 * middle, 100 * fast)};
}

Outcome pl_rigid_hind_feet(Case& c) {
  const Figure ratio = c.straight("pl-rigid", kSand, 3.0, kFastest, [](const auto& groups) {
    std::vector<double> of_failures;
    for (const RunGroup* group : groups) {
      const auto &success = group->values("success"), &all = group->values("hind_over_front");
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (success[i] == 0.0) of_failures.push_back(all[i]);
      }
    }
    return SeedValue{mean_of(of_failures)};
  });
  return {median(ratio) > 1.2, median(ratio) < 1.0, printed(ratio, 1.0, 2)};
}

Outcome pl_gm_success(Case& c) { return success(c, "pl-gm"); }

Outcome pl_gm_slow(Case& c) {
  const Figure share = c.success("pl-gm", kSand, 0.5, 2.5);
  return {median(share) == 1.0, median(share) < 72.0 / 80.0, percent(share)};
}

Outcome pl_gm_clearance(Case& c) {
  const auto iqr = [&](const char* controller) {
    return c.straight(controller, kSand, 1.0, 2.0, [](auto groups) {
      std::erase_if(groups, [](const RunGroup* g) { return g->command == 1.5; });
      return mean_of_successes(groups, "iqr_m");
    });
  };
  const Figure mine = iqr("pl-gm");
  bool above_all = true;
  std::vector<double> others;
  for (const char* other : {"ours", "env-rigid", "env-quasistatic", "env-linear", "pl-rigid"}) {
    above_all = c.above_by_share(mine, iqr(other), 0.2) && above_all;
    others.push_back(median(iqr(other)));
  }
  return {above_all, median(mine) < median_of(others),
          fmt::format("{} mm; median of the others {:.1f}", printed(mine, 1e3, 1),
                      1e3 * median_of(others))};
}

Outcome pl_gm_limits(Case& c) {
  const auto share = [&](const char* controller) {
    return c.straight(controller, kSand, 3.0, kFastest,
                      [](const auto& groups) { return mean_value(groups, "limit_alone"); });
  };
  return {median(share("pl-gm")) >= 0.2, median(share("pl-gm")) <= median(share("ours")),
          fmt::format("{}; Ours {}", percent(share("pl-gm")), percent(share("ours")))};
}

Outcome order_of_speeds(Case& c) {
  std::vector<double> ours, theirs;
  for (const paper::BeachRow& row : paper::kBeach) {
    ours.push_back(median(c.top_speed(row.controller, kSand)));
    theirs.push_back(row.top_mps);
  }
  const double tau = kendall_tau(ours, theirs);
  return {tau >= 0.6, tau <= 0.0, fmt::format("tau {:.2f}", tau)};
}

Outcome faster_than_pl_rigid(Case& c) {
  return c.excess(c.top_speed("ours", kSand), c.top_speed("pl-rigid", kSand),
                  paper::kFasterThanPlRigid);
}

Outcome faster_than_pl_gm(Case& c) {
  return c.excess(c.top_speed("ours", kSand), c.top_speed("pl-gm", kSand), paper::kFasterThanPlGm);
}

Outcome cheaper_than_pl(Case& c) {
  int compared = 0, higher = 0;
  bool lower = true;
  for (const char* other : {"pl-gm", "pl-rigid"}) {
    for (const double command : straight_commands()) {
      if (!c.both_succeed("ours", other, kSand, command)) continue;
      const Figure a = c.mean("ours", kSand, command, command, "cot");
      const Figure b = c.mean(other, kSand, command, command, "cot");
      ++compared;
      higher += median(a) > median(b);
      lower = c.below_by_share(a, b, 0.1) && lower;
    }
  }
  if (compared == 0) c.set_too_few();
  return {lower && compared > 0, 2 * higher > compared,
          fmt::format("higher in {} of {} comparisons", higher, compared)};
}

/// A figure at the command whose average speed is nearest to 1 m/s.
Figure at_one_mps(const Case& c, const char* controller, const char* name) {
  return c.straight(controller, kSand, kSlowest, kFastest, [&](const auto& groups) {
    const RunGroup* nearest = nearest_to(groups, 1.0);
    return nearest != nullptr ? mean_of_successes({nearest}, name) : SeedValue{paper::kNotPrinted};
  });
}

Outcome peak_torques(Case& c) {
  bool below_all = true, above_median = true;
  std::string text;
  for (const char* name : {"peak_hfe_nm", "peak_kfe_nm"}) {
    const Figure ours = at_one_mps(c, "ours", name);
    std::vector<double> others;
    for (const char* other : kOthers) {
      below_all = c.above(at_one_mps(c, other, name), ours) && below_all;
      others.push_back(median(at_one_mps(c, other, name)));
    }
    above_median = above_median && median(ours) > median_of(others);
    text += fmt::format("{}{} N m; median of the others {:.1f}", text.empty() ? "" : "; ",
                        printed(ours, 1.0, 1), median_of(others));
  }
  return {below_all, above_median, text};
}

Outcome env_rigid_success(Case& c) { return success(c, "env-rigid"); }

Outcome env_rigid_fails_fast(Case& c) {
  const Figure difference =
      c.straight("env-rigid", kSand, kSlowest, kFastest, [](const auto& groups) {
        std::vector<double> failed, succeeded;
        for (const RunGroup* group : groups) {
          for (const double success : group->values("success")) {
            (success == 1.0 ? succeeded : failed).push_back(group->command);
          }
        }
        return SeedValue{mean_of(failed) - mean_of(succeeded)};
      });
  return {median(difference) >= 0.5, median(difference) < 0.0,
          printed(difference, 1.0, 2) + " m/s"};
}

Outcome extension_power(Case& c) {
  return c.excess(at_one_mps(c, "pl-rigid", "extension_w"),
                  at_one_mps(c, "env-rigid", "extension_w"), paper::kExtensionExcess, "W");
}

Outcome quasistatic_completes(Case& c) {
  bool all = true;
  int poor = 0;
  std::string text;
  for (const double command : {1.0, 1.5, 2.0, 2.5, 3.0}) {
    const double share = median(c.success("env-quasistatic", kSand, command, command));
    all = all && share >= 15.0 / 16.0;
    poor += share < 12.0 / 16.0;
    text += fmt::format("{}{:.0f}", text.empty() ? "" : ", ", 100.0 * share);
  }
  return {all, poor >= 2, text + " %"};
}

Outcome quasistatic_fails_fast(Case& c) {
  const Figure share = c.success("env-quasistatic", kSand, 3.5, kFastest);
  return {median(share) <= 0.5, median(share) >= 0.9, percent(share)};
}

Outcome quasistatic_cost(Case& c) {
  const Figure theirs = c.mean("env-quasistatic", kSand, 1.0, 3.0, "cot");
  const Figure ours = c.mean("ours", kSand, 1.0, 3.0, "cot");
  const double ratio = median(theirs) / median(ours);
  return {ratio >= 0.85 && ratio<1.0, ratio> 1.0,
          fmt::format("{}; Ours {}", printed(theirs, 1.0, 3), printed(ours, 1.0, 3))};
}

Outcome linear_success(Case& c) {
  const double share = median(overall_success(c, "env-linear"));
  int lower = 0;
  for (const char* other : {"ours", "env-rigid", "env-quasistatic", "pl-gm", "pl-rigid"}) {
    lower += median(overall_success(c, other)) < share;
  }
  const Outcome by_share = success(c, "env-linear");
  return {by_share.agrees && lower == 0, lower >= 2, by_share.ours};
}

Outcome linear_falls(Case& c) {
  const Figure falls = c.straight("env-linear", kSand, kSlowest, kFastest, [](const auto& groups) {
    std::vector<double> fell;
    for (const RunGroup* group : groups) {
      const auto &success = group->values("success"), &alive = group->values("alive");
      for (std::size_t i = 0; i < success.size(); ++i) {
        if (success[i] == 0.0) fell.push_back(alive[i] == 0.0);
      }
    }
    return SeedValue{mean_of(fell)};
  });
  return {median(falls) >= 0.5, median(falls) < 0.25, percent(falls)};
}

Outcome outperforms(Case& c) {
  int better = 0, most = 0;
  for (const char* other : kOthers) {
    int success = 0, speed = 0, cost = 0;
    for (const double v : straight_commands()) {
      const auto value = [&](const char* who, const char* name) {
        return median(c.mean(who, kSand, v, v, name));
      };
      success += median(c.success(other, kSand, v, v)) > median(c.success("ours", kSand, v, v));
      speed += value(other, "speed_mps") > value("ours", "speed_mps");
      cost += value(other, "cot") < value("ours", "cot");
    }
    better += success + speed + cost;
    most = std::max({most, success, speed, cost});
  }
  const auto commands = static_cast<int>(straight_commands().size());
  return {better == 0, 2 * most > commands,
          fmt::format("another one is better in {} comparisons; in one figure at up to {} of {} "
                      "commands",
                      better, most, commands)};
}

Outcome ablations_help_little(Case& c) {
  const double rigid = median(overall_success(c, "env-rigid"));
  const double linear = median(overall_success(c, "env-linear")) - rigid;
  const double quasistatic = median(overall_success(c, "env-quasistatic")) - rigid;
  return {linear < 0.25 && quasistatic<0.25, linear> 0.5 && quasistatic > 0.5,
          fmt::format("{:+.0f} and {:+.0f} points", 100.0 * linear, 100.0 * quasistatic)};
}

}  // namespace

const std::vector<ClaimRule>& beach_rules() {
  static const std::vector<ClaimRule> kRules = {
      {"1", {"E1"}, {"ours"}, top_speed},
      {"3", {"E1"}, {"ours"}, sinking},
      {"8", {"E1"}, {"ours"}, no_failure},
      {"9", {"E1"}, {"pl-rigid"}, pl_rigid_success},
      {"10", {"E1"}, {"pl-rigid"}, pl_rigid_bell},
      {"12", {"E1"}, {"pl-rigid"}, pl_rigid_hind_feet},
      {"13", {"E1"}, {"pl-gm"}, pl_gm_success},
      {"14", {"E1"}, {"pl-gm"}, pl_gm_slow},
      {"15", {"E1"}, beach_controllers(), pl_gm_clearance},
      {"16", {"E1"}, {"ours", "pl-gm"}, pl_gm_limits},
      {"17", {"E1"}, beach_controllers(), order_of_speeds},
      {"18", {"E1"}, {"ours", "pl-rigid"}, faster_than_pl_rigid},
      {"19", {"E1"}, {"ours", "pl-gm"}, faster_than_pl_gm},
      {"20", {"E1"}, {"ours", "pl-gm", "pl-rigid"}, cheaper_than_pl},
      {"21", {"E1"}, beach_controllers(), peak_torques},
      {"22", {"E1"}, {"env-rigid"}, env_rigid_success},
      {"23", {"E1"}, {"env-rigid"}, env_rigid_fails_fast},
      {"24", {"E1"}, {"env-rigid", "pl-rigid"}, extension_power},
      {"25", {"E1"}, {"env-quasistatic"}, quasistatic_completes},
      {"26", {"E1"}, {"env-quasistatic"}, quasistatic_fails_fast},
      {"27", {"E1"}, {"ours", "env-quasistatic"}, quasistatic_cost},
      {"28", {"E1"}, beach_controllers(), linear_success},
      {"29", {"E1"}, {"env-linear"}, linear_falls},
      {"69", {"E1"}, beach_controllers(), outperforms},
      {"70", {"E1"}, {"env-rigid", "env-quasistatic", "env-linear"}, ablations_help_little},
  };
  return kRules;
}

}  // namespace sandrunner::study
