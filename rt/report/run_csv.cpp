// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_csv.h"

#include <fmt/format.h>

#include <functional>
#include <limits>

#include "rt/base/output_files.h"
#include "rt/core/mode_machine.h"

namespace sandrunner {
namespace {

/// Calls `column(name, value)` for every column of a sample: names and values cannot part.
void for_each_column(const RunSample& s, const RunScene& scene,
                     const std::function<void(const std::string&, double)>& column) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  // What only the truth tells.
  const auto truth = [&](const std::string& name, double value) {
    column(name, s.has_truth ? value : kUnknown);
  };
  const auto vector = [&](const std::string& name, const std::string& unit, const Vector3& v) {
    for (std::size_t i = 0; i < 3; ++i) truth(name + "_" + "xyz"[i] + unit, v[i]);
  };
  const auto joints = [&](const std::string& name, const JointArray<double>& values) {
    for (std::size_t i = 0; i < kNumJoints; ++i) column(scene.joint_names[i] + name, values[i]);
  };
  const auto estimate = [&](const std::string& name, const StateEstimate& e, bool exists) {
    const auto known = [&](double value) { return exists ? value : kUnknown; };
    column(name + "_body_height_m", known(e.body_height_m));
    for (std::size_t i = 0; i < 3; ++i) {
      column(name + "_velocity_" + "xyz"[i] + "_mps", known(e.velocity_mps[i]));
    }
    for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
      column(name + "_" + scene.leg_names[leg] + "_foot_height_m", known(e.foot_height_m[leg]));
    }
  };

  column("command_vx_mps", s.command.vx_mps);
  column("command_vy_mps", s.command.vy_mps);
  column("command_wz_radps", s.command.wz_radps);
  vector("base", "_m", s.base_position_m);
  for (std::size_t i = 0; i < 4; ++i) {
    column(std::string("orientation_") + "wxyz"[i], s.orientation_wxyz[i]);
  }
  truth("vx_mps", s.vx_mps);
  truth("vy_mps", s.vy_mps);
  column("yaw_rate_radps", s.yaw_rate_radps);
  joints("_position_rad", s.joint_position_rad);
  joints("_velocity_radps", s.joint_velocity_radps);
  joints("_torque_nm", s.joint_torque_nm);
  for (std::size_t leg = 0; leg < kNumLegs; ++leg) {
    const std::string name = scene.leg_names[leg];
    vector(name + "_hip", "_m", s.hip_position_m[leg]);
    vector(name + "_knee", "_m", s.knee_position_m[leg]);
    vector(name + "_foot", "_m", s.foot_position_m[leg]);
    truth(name + "_penetration_m", s.penetration_m[leg]);
    truth(name + "_ground_height_m", s.ground_height_m[leg]);
    truth(name + "_contact", s.contact[leg] ? 1.0 : 0.0);
  }
  estimate("estimate", s.estimate, s.has_estimate);
  estimate("truth", s.truth, s.has_truth);
}

}  // namespace

std::vector<std::string> csv_columns(const RunScene& scene) {
  std::vector<std::string> names = {"t_s", "mode"};
  for_each_column(RunSample{}, scene,
                  [&](const std::string& name, double) { names.push_back(name); });
  return names;
}

void write_csv(const RunRecord& record, const std::string& path) {
  std::string text = fmt::format("{}\n", fmt::join(csv_columns(record.scene), ","));
  for (const RunSample& sample : record.samples) {
    text += fmt::format("{:.9g},{}", sample.t_s, mode_name(sample.mode));
    for_each_column(sample, record.scene, [&](const std::string&, double value) {
      text += fmt::format(",{:.9g}", value);
    });
    text += '\n';
  }
  write_file(path, text);
}

}  // namespace sandrunner
