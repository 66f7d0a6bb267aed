// SPDX-License-Identifier: BSD-3-Clause
// E8: what the answers of the two oracles depend on. Names of the numbers that it measures, in a
// group of runs on kOracleGround:
//   runs: ablation of the groups of inputs "cmd", "h" or "o", "e" and "T"; a run is a block of 48
//   robots, which has the same starts, grounds and commands for every controller
//   lists: "states", "robots", "fell" (share of the robots), "gap_median", "gap_p99"; in ten bins
//   of sigma_flat "bin_sigma_npm3" (middle), "bin_states", "bin_T" (ablation of T); of each
//   parameter of the ground "deviation", "alone" (its ablation), and the lists of kOracleJoints
#pragma once

#include <cstddef>
#include <vector>

#include "rt/core/messages.h"
#include "tools/study/evidence/evidence.h"

namespace sandrunner::study {

inline constexpr const char* kOracleGround = "training";

/// Parameters of the ground as the actor sees them (train::terrain_features).
struct TerrainParameter {
  const char* name;
  const char* seen_as;  ///< in HTML
  bool varies;          ///< on soil alone; the others are constant there
};
inline constexpr TerrainParameter kTerrainParameters[] = {
    {"rigid", "1 on hard ground, else 0", false},
    {"&sigma;_flat", "log10(&sigma;_flat / 3 MN/m&sup3;)", true},
    {"&sigma;_cone", "2 log10(&sigma;_cone / 0.3 MN/m&sup3;)", true},
    {"friction", "3 (&mu; - 0.75)", true},
    {"inertia", "2 (factor - 0.65)", true},
    {"roughness", "100 roughness / m", false},
    {"recruitment", "(&nu; - 2) / 0.3", true},
    {"cone angle", "(&theta; - 60&deg;) / 4&deg;", true},
    {"stroke stiffness", "(k_h - 225 N/m) / 175 N/m", true},
    {"stroke damping", "(b_h - 2 N s/m) / 2 N s/m", true},
};
inline constexpr int kSigmaFlat = 1, kSigmaCone = 2, kInertia = 4;

/// A kind of joint, and the list with the mean |integrated gradient| of each parameter.
struct OracleJoint {
  const char* name;
  const char* list;
};
inline constexpr OracleJoint kOracleJoints[kJointsPerLeg] = {
    {"HAA", "gradient_haa"}, {"HFE", "gradient_hfe"}, {"KFE", "gradient_kfe"}};

/// The two oracles.
const std::vector<const char*>& oracle_controllers();

/// Ablation of a group of inputs of an oracle that was run, the mean over the blocks of robots.
Figure oracle_ablation(const Evidence& evidence, const char* oracle, const char* group);
/// A value of a list of an oracle that was run.
Figure oracle_value(const Evidence& evidence, const char* oracle, const char* list, std::size_t at);

}  // namespace sandrunner::study
