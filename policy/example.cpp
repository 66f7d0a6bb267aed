// SPDX-License-Identifier: BSD-3-Clause
// Loads a policy file and steps it by hand, for a robot that is held still in its nominal pose.
#include <cmath>
#include <cstdio>
#include <exception>

#include "policy/policy_file.h"

int main(int, char** argv) try {
  // Loading checks the file and runs its golden example.
  sandrunner::Policy policy = sandrunner::load_policy(argv[1]);
  const sandrunner::JointArray<double>& nominal_rad = policy.spec().nominal_position_rad;

  // The observation: command 0 to 2, world's z axis 3 to 5, angular velocity 6 to 8, joint
  // positions 9 to 20, joint velocities 21 to 32.
  std::array<float, sandrunner::kObservationSize> observation{};
  observation[5] = 1.0F;
  for (int j = 0; j < sandrunner::kNumJoints; ++j) {
    observation[9 + j] = static_cast<float>(nominal_rad[j]);
  }

  // One second of steps at 100 Hz without a command, then one at 1 m/s forward.
  sandrunner::PolicyStep step[2];
  for (const int speed_mps : {0, 1}) {
    observation[0] = static_cast<float>(speed_mps);
    for (int i = 0; i < sandrunner::kPolicyHz; ++i) step[speed_mps] = policy.step(observation);
    std::printf("commanded %d m/s: the LF hip's target is %.3f rad; ", speed_mps,
                step[speed_mps].target_rad[1]);
    std::printf("the body is estimated %.2f m high, at %.2f m/s\n",
                step[speed_mps].estimate.body_height_m, step[speed_mps].estimate.velocity_mps[0]);
  }

  // The command moves the leg, and the estimate is that of a robot that stands.
  const bool obeys = std::abs(step[1].target_rad[1] - step[0].target_rad[1]) > 0.1;
  return obeys && std::abs(step[0].estimate.body_height_m - 0.47) < 0.05 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 2;
}
