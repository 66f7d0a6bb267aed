// SPDX-License-Identifier: BSD-3-Clause
// The claims of CLAIMS.md and their verdicts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/study/evidence/evidence.h"

namespace sandrunner::study {

/// A row of CLAIMS.md.
struct Claim {
  std::string id, quote, figure, agrees_if, contradicts_if;
  std::string section;  ///< the heading above it
};

/// The rows of the tables of claims in this Markdown. Throws std::runtime_error if there are none.
std::vector<Claim> read_claims(std::string_view markdown);
/// Those of CLAIMS.md, which is built into the program.
const std::vector<Claim>& claims();

struct Judgement {
  Verdict verdict = Verdict::kCannotTell;
  /// Why nothing can be told: "not run", "not competently trained"; empty: neither condition holds.
  std::string reason = {};
  bool one_seed = false;  ///< the verdict rests on one seed of a controller
  std::string ours = {};  ///< our figures, for the reader
};

/// "can't tell (not run)", "agrees (1 seed)"
std::string judgement_text(const Judgement& judgement);

Judgement judge(const Claim& claim, const Evidence& evidence);

}  // namespace sandrunner::study
