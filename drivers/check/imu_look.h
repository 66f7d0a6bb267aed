// SPDX-License-Identifier: BSD-3-Clause
// Checks the readings of an IMU on a robot at rest.
#pragma once

#include <string>
#include <vector>

#include "rt/core/messages.h"

namespace sandrunner {

/// Means of the samples of a robot at rest.
struct ImuFigures {
  int samples = 0;
  double rate_hz = 0.0;  ///< of all samples that the device sent, used here or not
  Vector3 acceleration_mps2{}, angular_velocity_radps{};
  double tilt_rad = 0.0;            ///< between the IMU's up direction and the body's z axis
  double attitude_error_rad = 0.0;  ///< between up by acceleration and up by orientation
};

/// Takes samples and makes their means.
class ImuLook {
 public:
  void add(const ImuSample& sample);
  /// `streamed`: samples that the device sent meanwhile, in `duration_s`.
  ImuFigures figures(std::uint64_t streamed, double duration_s) const;

 private:
  int samples_ = 0;
  Vector3 acceleration_{}, angular_velocity_{}, up_{};  // sums; up_ by the orientation, body frame
};

/// The problems, a line each, for a robot that is level and still. `rate_hz`: the
/// configured one.
std::vector<std::string> imu_problems(const ImuFigures& figures, double rate_hz);

/// The angle by which the person should lift the robot's front.
inline constexpr double kAskedTilt_deg = 20.0;

/// Judges the specific force, body frame, of a robot at rest: level, then with its front lifted by
/// about kAskedTilt_deg. A level robot cannot show about which axis an IMU is turned in its
/// mounting; this can. In words, with what to look at.
struct FrontLift {
  bool good = false;
  std::string words;
};
FrontLift judge_front_lift(const Vector3& level_mps2, const Vector3& lifted_mps2);

}  // namespace sandrunner
