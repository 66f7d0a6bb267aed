// SPDX-License-Identifier: BSD-3-Clause
// Numbers that the paper prints: Choi et al., "Learning quadrupedal locomotion on deformable
// terrain", Science Robotics 8 (2023). What it shows in pictures only is not here.
#pragma once

#include <limits>

namespace sandrunner::study::paper {

inline constexpr double kNotPrinted = std::numeric_limits<double>::quiet_NaN();

/// Table 1 and the success rates of the text ("Beach sand").
struct BeachRow {
  const char* controller;  ///< Controller::key
  double success;          ///< of 40 trials
  double average_mps;      ///< "Maximum average speed over 5 m"
  double top_mps;          ///< "Maximum speed after acceleration"
};
inline constexpr BeachRow kBeach[] = {
    {"ours", 1.0, 2.427, 3.028},
    {"env-rigid", 0.5, 1.163, 1.234},
    {"env-quasistatic", kNotPrinted, 1.866, 1.959},
    {"env-linear", 0.175, 1.101, 1.658},
    {"pl-gm", 0.725, 1.838, 2.009},
    {"pl-rigid", 0.375, 1.567, 1.652},
};

/// "the maximum speed of Ours was 83.3 and 50.7% faster" than PL/Env-Rigid's and PL/Env-GM's.
inline constexpr double kFasterThanPlRigid = 0.833, kFasterThanPlGm = 0.507;
/// P_mech^E "was 52.5% larger for the PL/Env-Rigid than the Env-Rigid".
inline constexpr double kExtensionExcess = 0.525;

/// "up to 3.13, 3.62, and 3.76 m/s on grass, athletic track, and vinyl tile".
inline constexpr double kTopGrass_mps = 3.13, kTopTrack_mps = 3.62, kTopVinyl_mps = 3.76;
/// "6.1 and 10.1% lower maximum speed than our controller on the running track and grass".
inline constexpr double kRigidLowerOnTrack = 0.061, kRigidLowerOnGrass = 0.101;

/// Yaw rates, rad/s: on dry sand; "in all terrains"; on the air mattress at commands of 1 and 2.
inline constexpr double kYawSand_radps = 0.92, kYawAll_radps = 0.94;
inline constexpr double kYawMattress1_radps = 0.71, kYawMattress2_radps = 1.54;

}  // namespace sandrunner::study::paper
