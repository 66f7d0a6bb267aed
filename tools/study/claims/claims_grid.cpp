// SPDX-License-Identifier: BSD-3-Clause
// The rules of claims 52 to 58, 60 to 62 and 68 on the grid of stiffnesses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "tools/evaluate/statistics.h"
#include "tools/study/claims/claim_rules.h"
#include "tools/study/evidence/controllers.h"
#include "tools/study/evidence/grid_evidence.h"

namespace sandrunner::study {
namespace {

constexpr std::size_t kPaperCells = 100;
constexpr const char* kSlopes[] = {"slope_flat_m", "slope_cone_m"};

// Whether the grid is the paper's. If not, the claims about its cells cannot be told.
bool is_papers(Case& c) {
  const bool is = grid_medians(c.evidence(), "ours", "reward").size() == kPaperCells;
  if (!is) c.set_too_few();
  return is;
}

Figure reward(const Case& c, const char* controller) {
  return grid_figure(c.evidence(), controller, "reward");
}

std::string reward_text(const Case& c, std::initializer_list<const char*> keys) {
  std::string text;
  for (const char* key : keys) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", find_controller(key)->name,
                        printed(reward(c, key), 1.0, 2));
  }
  return text;
}

// mm a decade of sigma_flat and of sigma_cone.
std::string slope_text(const Case& c, const char* controller) {
  const auto slope = [&](const char* name) {
    return printed(grid_figure(c.evidence(), controller, name), 1e3, 1);
  };
  return fmt::format("{} {} and {}", find_controller(controller)->name, slope(kSlopes[0]),
                     slope(kSlopes[1]));
}

Outcome loses_on_soft_ground(Case& c) {
  if (!is_papers(c)) return {};
  const auto lost = [&](const char* controller) {
    return c.evidence().figure("E7", controller, [](const Measured& m) {
      const SoftAndStiff reward = soft_and_stiff(m, "reward");
      return SeedValue{1.0 - reward.soft / reward.stiff};
    });
  };
  const double ours = median(lost("ours"));
  bool both = true, neither = true;
  std::string text = fmt::format("lost: Ours {} %", printed(lost("ours"), 100.0, 0));
  for (const char* other : {"env-rigid", "pl-rigid"}) {
    const double more = median(lost(other)) - ours;
    both = both && more >= 0.30;
    neither = neither && more <= 0.0;
    text += fmt::format(", {} {} %", find_controller(other)->name, printed(lost(other), 100.0, 0));
  }
  return {both, neither, text};
}

// Slopes of clearance of all these against those of Ours.
Outcome adapts_less(Case& c, std::initializer_list<const char*> others) {
  if (!is_papers(c)) return {};
  bool below_half = true, above_ours = true;
  std::string text = slope_text(c, "ours");
  for (const char* other : others) {
    for (const char* name : kSlopes) {
      const double ours = std::fabs(median(grid_figure(c.evidence(), "ours", name)));
      const double theirs = std::fabs(median(grid_figure(c.evidence(), other, name)));
      below_half = below_half && theirs < 0.5 * ours;
      above_ours = above_ours && theirs > ours;
    }
    text += ", " + slope_text(c, other);
  }
  return {below_half, above_ours, text + " mm a decade"};
}

Outcome rigid_ones_adapt_less(Case& c) { return adapts_less(c, {"env-rigid", "pl-rigid"}); }
Outcome tcn_adapts_less(Case& c) { return adapts_less(c, {"tcn"}); }

Outcome both_adapt(Case& c) {
  if (!is_papers(c)) return {};
  constexpr double kLeast_m = 0.005;
  bool all = true, one_does_not = false;
  std::string text;
  for (const char* controller : {"ours", "pl-gm"}) {
    bool all_include_zero = true;
    for (const char* name : kSlopes) {
      const Figure slope = grid_figure(c.evidence(), controller, name);
      all = all && median(slope) <= -kLeast_m;
      for (const auto& [seed, value] : slope) {
        const evaluate::Estimate mean = evaluate::mean_interval(value.runs);
        const bool includes_zero = mean.low <= 0.0 && mean.high >= 0.0;
        all = all && mean.n >= kLeastPairs && !includes_zero;
        all_include_zero = all_include_zero && includes_zero;
      }
    }
    one_does_not = one_does_not || all_include_zero;
    text += (text.empty() ? "" : ", ") + slope_text(c, controller);
  }
  return {all, one_does_not, text + " mm a decade"};
}

// In how many cells `better(ours, other)` holds; not where one of them has no value.
Outcome in_most_cells(Case& c, const char* other, const char* name,
                      const std::function<bool(double ours, double other)>& better) {
  if (!is_papers(c)) return {};
  const std::vector<double> ours = grid_medians(c.evidence(), "ours", name);
  const std::vector<double> theirs = grid_medians(c.evidence(), other, name);
  int cells = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) cells += better(ours[i], theirs[i]);
  return {cells >= 95, cells < 50, fmt::format("in {} of {} cells", cells, ours.size())};
}

Outcome outperforms_pl(Case& c) { return in_most_cells(c, "pl-gm", "reward", std::greater<>()); }
Outcome lifts_less_than_pl(Case& c) {
  return in_most_cells(c, "pl-gm", "clearance_m", std::less<>());
}

Outcome recurrent_is_better(Case& c) {
  const Figure ours = reward(c, "ours"), tcn = reward(c, "tcn");
  return {c.above(ours, tcn), c.above(tcn, ours), reward_text(c, {"ours", "tcn"})};
}

Outcome teacher_is_worse(Case& c) {
  const Figure teacher = reward(c, "teacher-gm");
  bool each_above = true, one_below = false;
  for (const char* other : {"ours", "oracle-h", "oracle-o"}) {
    each_above = c.above(reward(c, other), teacher) && each_above;
    one_below = c.above(teacher, reward(c, other)) || one_below;
  }
  return {each_above, one_below, reward_text(c, {"teacher-gm", "ours", "oracle-h", "oracle-o"})};
}

Outcome oracle_h_is_best(Case& c) {
  const Figure h = reward(c, "oracle-h"), o = reward(c, "oracle-o");
  bool best = true;
  std::string best_other;
  double most = -INFINITY;
  for (const char* other : grid_controllers()) {
    if (std::string_view(other) == "oracle-h") continue;
    const double theirs = median(reward(c, other));
    best = best && median(h) > theirs;
    if (theirs > most) best_other = other;
    most = std::fmax(most, theirs);
  }
  std::string text = reward_text(c, {"oracle-h", "oracle-o"});
  if (best_other != "oracle-o") {
    text += fmt::format("; best of the others: {}", reward_text(c, {best_other.c_str()}));
  }
  return {c.above_by_share(h, o, 0.03) && best, c.above(o, h), text};
}

Outcome oracle_o_is_like_ours(Case& c) {
  constexpr double kShare = 0.03;
  const Figure o = reward(c, "oracle-o");
  const double ours = median(reward(c, "ours"));
  return {is_about(o, ours, kShare), is_far_from(o, ours, kShare),
          reward_text(c, {"oracle-o", "ours"})};
}

Outcome student_is_bounded(Case& c) {
  const Figure student = reward(c, "pl-gm"), teacher = reward(c, "teacher-gm");
  return {median(student) <= median(teacher), c.above(student, teacher),
          reward_text(c, {"pl-gm", "teacher-gm"})};
}

}  // namespace

const std::vector<ClaimRule>& grid_rules() {
  static const std::vector<ClaimRule> kRules = {
      {"52", {"E7"}, {"ours", "env-rigid", "pl-rigid"}, loses_on_soft_ground},
      {"53", {"E7"}, {"ours", "env-rigid", "pl-rigid"}, rigid_ones_adapt_less},
      {"54", {"E7"}, {"ours", "pl-gm"}, both_adapt},
      {"55", {"E7"}, {"ours", "pl-gm"}, outperforms_pl},
      {"56", {"E7"}, {"ours", "pl-gm"}, lifts_less_than_pl},
      {"57", {"E7"}, {"ours", "tcn"}, recurrent_is_better},
      {"58", {"E7"}, {"ours", "tcn"}, tcn_adapts_less},
      {"60", {"E7"}, {"ours", "teacher-gm", "oracle-h", "oracle-o"}, teacher_is_worse},
      {"61", {"E7"}, grid_controllers(), oracle_h_is_best},
      {"62", {"E7"}, {"ours", "oracle-o"}, oracle_o_is_like_ours},
      {"68", {"E7"}, {"pl-gm", "teacher-gm"}, student_is_bounded},
  };
  return kRules;
}

}  // namespace sandrunner::study
