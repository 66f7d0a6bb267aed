// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/claims/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "tools/study/claims/claim_rules.h"
#include "tools/study/claims/embedded.h"

namespace sandrunner::study {
namespace {

std::string trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(' ') - begin + 1));
}

// The cells of a row of a Markdown table.
std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t at = line.find('|'); at != std::string_view::npos;) {
    const std::size_t next = line.find('|', at + 1);
    if (next == std::string_view::npos) break;
    cells.push_back(trimmed(line.substr(at + 1, next - at - 1)));
    at = next;
  }
  return cells;
}

const ClaimRule* rule_of(const std::string& id) {
  for (const std::vector<ClaimRule>* rules :
       {&beach_rules(), &ground_rules(), &grid_rules(), &attribution_rules()}) {
    for (const ClaimRule& rule : *rules) {
      if (id == rule.id) return &rule;
    }
  }
  return nullptr;
}

// Whether all that the rule needs was measured, and with enough runs; `one_seed` is set.
bool was_run(const ClaimRule& rule, const Evidence& evidence, bool& one_seed) {
  if (rule.controllers.empty()) return evidence.contact.has_value();
  for (const char* controller : rule.controllers) {
    for (const char* experiment : rule.experiments) {
      const auto* seeds = evidence.find(experiment, controller);
      if (seeds == nullptr) return false;
      one_seed = one_seed || seeds->size() == 1;
      for (const auto& [seed, measured] : *seeds) {
        for (const RunGroup& group : measured.groups) {
          if (!group.runs.empty() && group.size() < kLeastPairs) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace

std::vector<Claim> read_claims(std::string_view markdown) {
  constexpr std::size_t kColumns = 5;
  std::vector<Claim> claims;
  std::string section;
  bool in_table = false;
  while (!markdown.empty()) {
    const std::string_view line = markdown.substr(0, markdown.find('\n'));
    markdown.remove_prefix(std::min(line.size() + 1, markdown.size()));
    if (line.starts_with("## ")) section = trimmed(line.substr(3));
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != kColumns) {
      in_table = false;
      continue;
    }
    if (in_table && !cells[0].starts_with("-")) {
      claims.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], section});
    }
    in_table = in_table || cells[0] == "id";
  }
  if (claims.empty()) throw std::runtime_error("CLAIMS.md: no table of claims");
  return claims;
}

const std::vector<Claim>& claims() {
  static const std::vector<Claim> kClaims = read_claims(study_files("CLAIMS.md"));
  return kClaims;
}

std::string judgement_text(const Judgement& judgement) {
  std::string text = verdict_name(judgement.verdict);
  if (!judgement.reason.empty()) text += fmt::format(" ({})", judgement.reason);
  if (judgement.one_seed) text += " (1 seed)";
  return text;
}

Judgement judge(const Claim& claim, const Evidence& evidence) {
  Judgement judgement;
  if (claim.agrees_if == verdict_name(Verdict::kNotTestable)) {
    judgement.verdict = Verdict::kNotTestable;
    return judgement;
  }
  const ClaimRule* rule = rule_of(claim.id);
  bool one_seed = false;
  if (rule == nullptr || !was_run(*rule, evidence, one_seed)) {
    judgement.reason = "not run";
    return judgement;
  }
  Case c(evidence);
  const Outcome outcome = rule->judge(c);
  judgement.ours = outcome.ours;
  for (const char* controller : rule->controllers) {
    if (!is_competent(evidence, controller)) {
      judgement.reason = "not competently trained";
      return judgement;
    }
  }
  if (c.too_few() && !outcome.agrees && !outcome.contradicts) {
    judgement.reason = "not run";
    return judgement;
  }
  judgement.one_seed = one_seed;
  if (outcome.agrees) judgement.verdict = Verdict::kAgrees;
  if (outcome.contradicts && !outcome.agrees) judgement.verdict = Verdict::kContradicts;
  return judgement;
}

// Case.

Outcome Case::excess(const Figure& a, const Figure& b, double x, const char* unit) {
  const double found = study::excess(a, b);
  return {above(a, b) && found >= 0.5 * x && found <= 2.0 * x, above(b, a),
          fmt::format("{} against {} {}: {:+.1f} %", printed(a, 1.0, 2), printed(b, 1.0, 2), unit,
                      100.0 * found)};
}

Figure Case::success(const std::string& controller, const std::string& ground, double low,
                     double high) const {
  return straight(controller, ground, low, high,
                  [](const auto& groups) { return mean_value(groups, "success"); });
}

Figure Case::mean(const std::string& controller, const std::string& ground, double low, double high,
                  const std::string& name) const {
  return straight(controller, ground, low, high,
                  [&](const auto& groups) { return mean_of_successes(groups, name); });
}

Figure Case::top_speed(const std::string& controller, const std::string& ground) const {
  return straight(controller, ground, 0.0, 10.0, [](const auto& groups) {
    return greatest_of_first_five(groups, "end_speed_mps");
  });
}

Figure Case::turn(const std::string& experiment, const std::string& controller,
                  const std::string& ground, double rate_radps, const std::string& name) const {
  return evidence_.figure(experiment, controller, [&](const Measured& m) {
    auto groups = between(m.select(ground, "turn"), rate_radps, rate_radps);
    const auto back = between(m.select(ground, "turn"), -rate_radps, -rate_radps);
    groups.insert(groups.end(), back.begin(), back.end());
    return mean_value(groups, name);
  });
}

bool Case::both_succeed(const std::string& a, const std::string& b, const std::string& ground,
                        double command) const {
  for (const std::string& controller : {a, b}) {
    const Figure count = straight(controller, ground, command, command, [](const auto& groups) {
      return SeedValue{groups.empty() ? 0.0 : successes(*groups[0])};
    });
    if (!(median(count) >= 8.0)) return false;
  }
  return true;
}

}  // namespace sandrunner::study
