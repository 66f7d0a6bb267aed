// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/nudge.h"

#include <fmt/format.h>

#include <cmath>

namespace sandrunner {
namespace {

using Verdict = Nudge::Verdict;

constexpr double kDamping_nmsprad = 2.0;
constexpr double kAtRest_radps = 0.2, kRest_s = 1.0, kRestlessAfter_s = 10.0;
/// Enabled, without torque: a drive needs some answers for it.
constexpr double kEnabling_s = 0.05;
constexpr double kLongestPush_s = 0.3;
constexpr double kLeast_rad = 0.01;
/// Ranges that are mixed up between models of one maker differ by as little as 1.3.
constexpr double kMostSpeedFactor = 1.2;
/// A torque that is reported within this factor of the one asked for is as it should be.
constexpr double kExactTorque = 1.1;
/// After the push, for what is on its way.
constexpr double kCoast_s = 0.01, kBrake_s = 0.3;
/// The first answers after the torque was asked for may be to the command before.
constexpr double kAnswer_s = 0.006;

class Pusher {
 public:
  Pusher(int joint, double torque_nm, const JointArray<bool>& damped, const NudgeExchange& exchange)
      : joint_(joint), damped_(damped), exchange_(exchange) {
    result_.asked_nm = torque_nm;
  }

  Nudge push() {
    if (wait_for_rest()) {
      if (spend(kEnabling_s, 0.0) && spend(kLongestPush_s, result_.asked_nm)) spend(kCoast_s, 0.0);
      if (!ended_) {
        judge();
        if (result_.verdict == Verdict::kGood) brake();
      }
      exchange_(points(std::nullopt));  // whatever came of it: no torque
    }
    return result_;
  }

 private:
  NudgePoints points(const std::optional<SetPoint>& pushed) const {
    NudgePoints points;
    for (int j = 0; j < kNumJoints; ++j) {
      if (damped_[j]) points[j] = SetPoint{.kd_nmsprad = kDamping_nmsprad};
    }
    points[joint_] = pushed;
    return points;
  }

  void end(Verdict verdict, int other) {
    result_.verdict = verdict;
    result_.other = other;
    ended_ = true;
  }

  /// False: the person wants an end, or a drive is not well.
  bool may_go_on(const NudgeState& state) {
    if (state.stop) {
      end(Verdict::kStopped, joint_);
      return false;
    }
    for (int j = 0; j < kNumJoints; ++j) {
      if (state.well[j]) continue;
      end(Verdict::kNotWell, j);
      return false;
    }
    return true;
  }

  int fastest(const NudgeState& state) const {
    int fastest = 0;
    for (int j = 1; j < kNumJoints; ++j) {
      if (std::fabs(state.velocity_radps[j]) > std::fabs(state.velocity_radps[fastest])) {
        fastest = j;
      }
    }
    return fastest;
  }

  bool wait_for_rest() {
    NudgeState state = exchange_(points(std::nullopt));
    const double start_s = state.time_s;
    for (double moved_s = start_s; state.time_s < moved_s + kRest_s;) {
      if (!may_go_on(state)) return false;
      const int j = fastest(state);
      if (std::fabs(state.velocity_radps[j]) > kAtRest_radps) moved_s = state.time_s;
      if (state.time_s > start_s + kRestlessAfter_s) {
        end(Verdict::kNotStill, j);
        return false;
      }
      state = exchange_(points(std::nullopt));
    }
    first_ = last_ = state;
    return true;
  }

  /// Exchanges with this torque for this long, or until the joint has moved enough. False: an end.
  bool spend(double most_s, double torque_nm) {
    const double start_s = last_.time_s;
    double torque_sum_nm = 0.0;
    int torques = 0;
    for (bool enough = false; !enough && last_.time_s < start_s + most_s;) {
      const NudgeState state = exchange_(points(SetPoint{.torque_nm = torque_nm}));
      if (!may_go_on(state)) return false;
      result_.travelled_rad += 0.5 * (state.time_s - last_.time_s) *
                               (last_.velocity_radps[joint_] + state.velocity_radps[joint_]);
      last_ = state;
      if (torque_nm == 0.0) continue;
      if (state.time_s > start_s + kAnswer_s) {
        torque_sum_nm += state.torque_nm[joint_];
        ++torques;
      }
      const int j = fastest(state);
      const bool fast = std::fabs(state.velocity_radps[j]) > kNudgeFastest_radps;
      if (fast && j != joint_) {
        end(Verdict::kOtherJoint, j);
        return false;
      }
      enough = fast || std::fabs(moved(joint_)) > kNudgeEnough_rad;
    }
    if (torque_nm != 0.0) {
      result_.pushed_s = last_.time_s - start_s;
      result_.reported_nm = torques > 0 ? torque_sum_nm / torques : last_.torque_nm[joint_];
    }
    return true;
  }

  void brake() {
    const double start_s = last_.time_s;
    NudgeState state = last_;
    while (state.time_s < start_s + kBrake_s) {
      state = exchange_(points(SetPoint{.kd_nmsprad = kDamping_nmsprad}));
      if (!may_go_on(state)) return;
      const double far_rad = state.position_rad[joint_] - first_.position_rad[joint_];
      if (std::fabs(far_rad) > kNudgeFarthest_rad) return;
    }
  }

  double moved(int j) const { return last_.position_rad[j] - first_.position_rad[j]; }

  void judge() {
    result_.moved_rad = moved(joint_);
    result_.other = joint_;
    for (int j = 0; j < kNumJoints; ++j) {
      if (std::fabs(moved(j)) > std::fabs(moved(result_.other))) result_.other = j;
    }
    const double scale = result_.travelled_rad / result_.moved_rad;
    const double torque_scale = result_.reported_nm / result_.asked_nm;
    if (std::fabs(result_.moved_rad) < kLeast_rad) {
      const bool other = std::fabs(moved(result_.other)) > 2.0 * kLeast_rad;
      result_.verdict = other ? Verdict::kOtherJoint : Verdict::kNotMoved;
    } else if (result_.moved_rad * result_.asked_nm < 0.0) {
      result_.verdict = Verdict::kWrongSign;
    } else if (!(scale > 1.0 / kMostSpeedFactor && scale < kMostSpeedFactor)) {
      result_.verdict = Verdict::kWrongSpeed;
    } else {
      const bool right = torque_scale > 0.5 && torque_scale < 1.5;
      result_.verdict = right ? Verdict::kGood : Verdict::kWrongTorque;
    }
  }

  int joint_;
  JointArray<bool> damped_;
  const NudgeExchange& exchange_;
  NudgeState first_, last_;
  Nudge result_;
  bool ended_ = false;
};

}  // namespace

Nudge nudge(int joint, double torque_nm, const JointArray<bool>& damped,
            const NudgeExchange& exchange) {
  return Pusher(joint, torque_nm, damped, exchange).push();
}

std::string nudge_words(const Nudge& n, int joint, const HardwareConfig& config,
                        const RobotDescription& robot) {
  const auto name_of = [&](int j) { return drive_name(config, robot, j); };
  const std::string name = name_of(joint);
  switch (n.verdict) {
    case Verdict::kGood: {
      const double ratio = n.reported_nm / n.asked_nm;
      const double reported_torque = config.drives[joint].reported_torque * ratio;
      const bool exact = ratio > 1.0 / kExactTorque && ratio < kExactTorque;
      return fmt::format(
          "{}: {:+.1f} N m moved it by {:+.3f} rad in {:.2f} s, as they should; reported are "
          "{:+.1f} N m{}",
          name, n.asked_nm, n.moved_rad, n.pushed_s, n.reported_nm,
          exact ? ""
                : fmt::format("; if it is so with other --nudge torques: reported_torque = {:.2f} "
                              "for its drive",
                              reported_torque));
    }
    case Verdict::kNotMoved:
      return fmt::format(
          "{}: {:+.1f} N m moved nothing, reported are {:+.1f} N m; is its motor connected, is "
          "the joint free?",
          name, n.asked_nm, n.reported_nm);
    case Verdict::kOtherJoint:
      return fmt::format("{}: was pushed, but the joint of {} moved", name, name_of(n.other));
    case Verdict::kWrongSign:
      return fmt::format(
          "{}: {:+.1f} N m moved it by {:+.3f} rad, the other way: its torque has the wrong sign; "
          "look at the drive's direction and phase order (calibrate it)",
          name, n.asked_nm, n.moved_rad);
    case Verdict::kWrongSpeed:
      return fmt::format(
          "{}: moved by {:+.3f} rad, by its velocity {:+.3f} rad: look at the range of its "
          "velocity, and at model",
          name, n.moved_rad, n.travelled_rad);
    case Verdict::kWrongTorque:
      return fmt::format(
          "{}: reports {:+.1f} N m where {:+.1f} were asked for: look at the ranges of its torque, "
          "and at model",
          name, n.reported_nm, n.asked_nm);
    case Verdict::kNotStill:
      return fmt::format("{}: not pushed, as {} does not come to rest", name, name_of(n.other));
    case Verdict::kNotWell:
      return fmt::format("{}: ended, as {} reports a fault or does not answer", name,
                         name_of(n.other));
    case Verdict::kStopped:
      break;
  }
  return fmt::format(
      "{}: stopped; if another joint moved, or this one another way: their places in the file are "
      "swapped, or sign",
      name);
}

}  // namespace sandrunner
