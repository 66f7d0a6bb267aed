// SPDX-License-Identifier: BSD-3-Clause
#include "rt/summary.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "rt/core/errors.h"

namespace sandrunner {

std::string summary_table(const RunResult& r, const CommandSource& command) {
  const RunFigures& f = r.figures;
  std::string t;
  const auto row = [&](const std::string& name, const std::string& value) {
    t += fmt::format("  {:<26}{}\n", name, value);
  };
  t += fmt::format("{}\n", r.interrupted ? "interrupted, ended in damping"
                           : r.survived  ? "finished on its feet"
                                         : fmt::format("FAILED: {} after {:.2f} s of Walk",
                                                       r.fall_reason, r.fall_time_s.value_or(0.0)));
  if (r.walked_s > 0.0) {
    t += fmt::format("over the second half of {:.1f} s in Walk, command {}:\n", r.walked_s,
                     command.text());
    row("velocity x, commanded",
        fmt::format("{:6.3f} m/s     of {:6.3f}", f.mean_velocity_mps[0], f.mean_command_mps[0]));
    row("velocity y, commanded",
        fmt::format("{:6.3f} m/s     of {:6.3f}", f.mean_velocity_mps[1], f.mean_command_mps[1]));
    row("yaw rate, commanded",
        fmt::format("{:6.3f} rad/s   of {:6.3f}", f.mean_yaw_rate_radps, f.mean_yaw_command_radps));
    row("sinkage mean, max", fmt::format("{:6.1f} mm      {:6.1f}   ({} stances)",
                                         1e3 * f.sinkage_mean_m, 1e3 * f.sinkage_max_m, f.stances));
    row("foot clearance (IQR)", fmt::format("{:6.1f} mm", 1e3 * f.foot_clearance_iqr_m));
    row("mechanical power", fmt::format("{:6.1f} W", f.mechanical_power_w));
    row("torque squared", fmt::format("{:6.0f} N^2m^2", f.torque_squared_nm2));
    row("cost of transport",
        f.cost_of_transport ? fmt::format("{:6.3f}", *f.cost_of_transport) : "     -");
    if (f.has_estimate) {
      row("estimate errors (rms)",
          fmt::format("{:6.3f} m/s, body height {:.1f} mm, foot height {:.1f} mm",
                      f.velocity_rmse_mps, 1e3 * f.body_height_rmse_m, 1e3 * f.foot_height_rmse_m));
    }
    row("past joint stop, too fast",
        fmt::format("{} and {} control steps", f.joint_limit_steps, f.speed_limit_steps));
  }
  row("state hash", fmt::format("{:016x}", r.state_hash));
  row("simulated",
      fmt::format("{:.1f} s, {:.0f} times real time", r.simulated_s, r.realtime_factor));
  return t;
}

std::string summary_json(const RunResult& r, const Options& options, const CommandSource& command,
                         const std::string& policy_name) {
  using Json = nlohmann::ordered_json;
  const RunFigures& f = r.figures;
  Json j;
  j["version"] = SANDRUNNER_VERSION;
  j["policy"] = policy_name.empty() ? Json() : Json(policy_name);
  j["terrain"] = options.terrain;
  j["seed"] = options.seed;
  j["survived"] = r.survived;
  j["fall_time_s"] = r.fall_time_s ? Json(*r.fall_time_s) : Json();
  j["fall_reason"] = r.survived ? Json() : Json(r.fall_reason);
  j["interrupted"] = r.interrupted;
  j["duration_s"] = r.walked_s;
  j["command"] = command.text();
  j["mean_velocity_mps"] = f.mean_velocity_mps;
  j["mean_yaw_rate_radps"] = f.mean_yaw_rate_radps;
  j["sinkage_mm"] = {{"mean", 1e3 * f.sinkage_mean_m}, {"max", 1e3 * f.sinkage_max_m}};
  j["foot_clearance_iqr_mm"] = 1e3 * f.foot_clearance_iqr_m;
  j["mechanical_power_w"] = f.mechanical_power_w;
  j["torque_squared_nm2"] = f.torque_squared_nm2;
  j["cost_of_transport"] = f.cost_of_transport ? Json(*f.cost_of_transport) : Json();
  j["estimator"] = f.has_estimate ? Json{{"velocity_rmse_mps", f.velocity_rmse_mps},
                                         {"body_height_rmse_m", f.body_height_rmse_m},
                                         {"foot_height_rmse_m", f.foot_height_rmse_m}}
                                  : Json();
  j["joint_limit_steps"] = f.joint_limit_steps;
  j["speed_limit_steps"] = f.speed_limit_steps;
  j["state_hash"] = fmt::format("{:016x}", r.state_hash);
  j["realtime_factor"] = r.realtime_factor;
  return j.dump(2) + "\n";
}

void write_text(const std::string& text, const std::string& path) {
  const std::string temporary = path + ".part";
  {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.close();
    if (!out) {
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      throw InputError(fmt::format("{}: cannot be written", path));
    }
  }
  std::filesystem::rename(temporary, path);
}

}  // namespace sandrunner
