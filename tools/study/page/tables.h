// SPDX-License-Identifier: BSD-3-Clause
// The tables of the page, as HTML, and claims.csv.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/study/claims/claims.h"
#include "tools/study/experiments/models.h"

namespace sandrunner::study {

/// A cell of a controller that was not run.
inline constexpr const char* kNotRun = "<span class=\"faint\">not run</span>";
/// "1, 2, 3"
std::string range_of_seeds(const std::map<int, Measured>& seeds);

struct JudgedClaim {
  Claim claim;
  Judgement judgement;
};

std::vector<JudgedClaim> judge_all(const Evidence& evidence);

std::string verdict_counts(const std::vector<JudgedClaim>& judged);
std::string verdict_tables(const std::vector<JudgedClaim>& judged);
std::string claims_csv(const std::vector<JudgedClaim>& judged);
std::string fairness_table(const Evidence& evidence);
/// Table 1 of the paper.
std::string beach_table(const Evidence& evidence);
std::string recovery_table(const Evidence& evidence);
std::string hidden_state_table(const Evidence& evidence);
std::string foam_table(const Evidence& evidence);
/// Stands for table S1 of the paper.
std::string grid_table(const Evidence& evidence);
/// What E8 rests on, and its numbers for each parameter of the ground.
std::string attribution_tables(const Evidence& evidence);
std::string contact_table(const Evidence& evidence);
std::string anchor_table();

}  // namespace sandrunner::study
