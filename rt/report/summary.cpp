// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/summary.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "rt/base/build.h"
#include "rt/base/fixed_text.h"
#include "rt/core/mode_machine.h"
#include "rt/loop/fault_remedy.h"
#include "rt/realtime/watchdog.h"

namespace sandrunner {

namespace {

/// A robot that follows less of the command than this did not do what was asked.
constexpr double kFollows = 0.5;

/// What the policy estimates: a network of others may say a part of it, or nothing.
std::string estimate_text(const EstimateErrors& errors) {
  std::string text;
  if (std::isfinite(errors.velocity_rmse_mps)) {
    text = fmt::format("{:6.3f} m/s", errors.velocity_rmse_mps);
  }
  if (std::isfinite(errors.body_height_rmse_m)) {
    text += fmt::format(", body height {:.1f} mm, foot height {:.1f} mm",
                        1e3 * errors.body_height_rmse_m, 1e3 * errors.foot_height_rmse_m);
  }
  return text;
}

double us(std::uint64_t ns) { return 1e-3 * static_cast<double>(ns); }

nlohmann::ordered_json histogram_json(const LogHistogram& h) {
  return {{"p50", us(h.quantile_ns(0.5))},
          {"p99", us(h.quantile_ns(0.99))},
          {"p99_9", us(h.quantile_ns(0.999))},
          {"max", us(h.max_ns())}};
}

nlohmann::ordered_json realtime_json(const RealtimeReport& r) {
  nlohmann::ordered_json j;
  j["ticks"] = r.control.ticks;
  j["ticks_skipped"] = r.control.skipped;
  j["longest_miss_ticks"] = r.control.longest_miss;
  j["policy_releases"] = r.control.releases;
  j["policy_steps"] = r.policy.steps;
  j["policy_missed"] = r.policy.missed;
  j["policy_late"] = r.late_policy_outputs;
  j["records_dropped"] = r.records_dropped;
  j["watchdog_longest_gap_ms"] = 1e-6 * static_cast<double>(r.watchdog_gap_ns);
  j["late_us"] = histogram_json(r.control.late);
  j["read_us"] = histogram_json(r.control.read);
  j["control_us"] = histogram_json(r.control.control);
  j["write_us"] = histogram_json(r.control.write);
  j["tick_us"] = histogram_json(r.control.busy);
  j["policy_step_us"] = histogram_json(r.policy.step);
  j["policy_answer_us"] = histogram_json(r.policy.answer);
  for (const SetupItem& item : r.setup) {
    j["setup"][item.name] = {{"obtained", item.obtained}, {"detail", item.detail}};
  }
  return j;
}

std::string realtime_table(const RealtimeReport& r) {
  std::string t = "real time, µs:                p50      p99    p99.9      max\n";
  const auto row = [&](const char* name, const LogHistogram& h) {
    t += fmt::format("  {:<22}{:>9.2f}{:>9.2f}{:>9.1f}{:>9.0f}\n", name, us(h.quantile_ns(0.5)),
                     us(h.quantile_ns(0.99)), us(h.quantile_ns(0.999)), us(h.max_ns()));
  };
  row("start after its time", r.control.late);
  row("sensors", r.control.read);
  row("control step", r.control.control);
  row("drives or simulator", r.control.write);
  row("whole tick", r.control.busy);
  row("policy step", r.policy.step);
  row("policy's answer after", r.policy.answer);
  t +=
      fmt::format("  {} ticks ran, {} skipped (longest {}); policy: {} steps, {} missed, {} late\n",
                  r.control.ticks, r.control.skipped, r.control.longest_miss, r.policy.steps,
                  r.policy.missed, r.late_policy_outputs);
  if (r.records_dropped > 0) {
    t += fmt::format("  {} ticks are not in the figures: they came faster than they were taken\n",
                     r.records_dropped);
  }
  if (r.watchdog_gap_ns >= kWatchdog_ns) {
    t += fmt::format(
        "  the watchdog did not look for {:.0f} ms: a control thread that hung would not "
        "have lost its drives\n",
        1e-6 * static_cast<double>(r.watchdog_gap_ns));
  }
  for (const SetupItem& item : r.setup) {
    t += fmt::format("  {:<26}{}{}\n", item.name,
                     item.obtained ? "" : "NOT OBTAINED: ", item.detail);
  }
  return t;
}

/// Names of the joints in `bits`.
std::vector<std::string> joints_in(std::uint64_t bits, const RobotDescription& robot) {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < kNumJoints; ++j) {
    if ((bits >> j & 1) != 0) names.push_back(robot.joint_names[j]);
  }
  return names;
}

/// What came of the run, in terms of what was asked.
std::string how_it_ended(const RunResult& r) {
  if (!r.has_truth) {
    return std::string(r.interrupted ? "interrupted, ended in damping"
                                     : "finished without a fault") +
           "; whether it fell is not known, there is no ground truth";
  }
  if (r.interrupted) return "interrupted, ended in damping";
  const std::optional<double> followed = r.figures.followed();
  if (!followed) return "finished on its feet";
  return fmt::format("{} followed {} % of the command",
                     *followed < kFollows ? "stayed up, but" : "finished on its feet,",
                     fixed_text(100.0 * *followed, 0));
}

}  // namespace

std::string summary_table(const RunResult& r, const RunInfo& info) {
  const RunFigures& f = r.figures;
  std::string t;
  const auto row = [&](const std::string& name, const std::string& value) {
    t += fmt::format("  {:<26}{}\n", name, value);
  };
  const auto of = [](const char* unit, double value, double commanded) {
    return fmt::format("{:>6} {}   of {:>6}", fixed_text(value, 3), unit, fixed_text(commanded, 3));
  };
  std::string end = how_it_ended(r);
  if (!r.survived) {
    end = "FAILED: " + r.fall_reason;
    const std::vector<std::string> joints =
        joints_in(r.end.gate.fault_joints, r.record.scene.robot);
    if (!joints.empty()) end += fmt::format(" ({})", fmt::join(joints, ", "));
    if (r.fall_mode) end += fmt::format(" in {},", mode_name(*r.fall_mode));
    if (r.fall_time_s) {
      end += *r.fall_time_s > 0.0 ? fmt::format(" after {:.2f} s of Walk", *r.fall_time_s)
                                  : " before it walked";
    }
  }
  t += end + "\n";
  if (const char* const remedy = fault_remedy(r.end.gate.first_fault); remedy && !r.survived) {
    t += fmt::format("  {}\n", remedy);
  }
  if (r.walked_s > 0.0) {
    t += fmt::format("over the second half of {:.1f} s in Walk, command {}:\n", r.walked_s,
                     info.command);
    if (r.end.gate.counters.command_clamped > 0) {
      t += "  the command left the policy's envelope and was clamped to it\n";
    }
    if (f.motion) {
      const MotionFigures& m = *f.motion;
      row("velocity x, commanded", of("m/s  ", m.mean_velocity_mps[0], f.mean_command_mps[0]));
      row("velocity y, commanded", of("m/s  ", m.mean_velocity_mps[1], f.mean_command_mps[1]));
      row("yaw rate, commanded", of("rad/s", m.mean_yaw_rate_radps, f.mean_yaw_command_radps));
      row("sinkage mean, max",
          fmt::format("{:6.1f} mm      {:6.1f}   ({} stances)", 1e3 * m.sinkage_mean_m,
                      1e3 * m.sinkage_max_m, m.stances));
      row("foot clearance (IQR)", fmt::format("{:6.1f} mm", 1e3 * m.foot_clearance_iqr_m));
    }
    row("mechanical power", fmt::format("{:>6} W", fixed_text(f.mechanical_power_w, 1)));
    row("torque squared", fmt::format("{:6.0f} N^2m^2", f.torque_squared_nm2));
    if (f.motion) {
      row("cost of transport", f.motion->cost_of_transport
                                   ? fmt::format("{:6.3f}", *f.motion->cost_of_transport)
                                   : "     -");
    }
    if (f.estimate) {
      const std::string text = estimate_text(*f.estimate);
      if (!text.empty()) row("estimate errors (rms)", text);
    }
    row("a joint past its stop", fmt::format("{:6} control steps", f.joint_limit_steps));
    row("a joint too fast", fmt::format("{:6} control steps", f.speed_limit_steps));
  }
  if (r.walked_s > 0.0) t += "over the whole run, lying and standing up included:\n";
  std::string counted;
  for (const GateCounterName& counter : kGateCounters) {
    const std::uint64_t ticks = r.end.gate.counters.*counter.ticks;
    // A robot that lies is past its stops; of a walk there is a row above.
    if (ticks > 0 && counter.ticks != &GateCounters::joint_past_stop) {
      counted += fmt::format("{}{} {}", counted.empty() ? "" : ", ", counter.name, ticks);
    }
  }
  if (!counted.empty()) row("safety gate, ticks", counted);
  row("state hash", fmt::format("{:016x}", r.end.state_hash));
  row("simulated", r.realtime ? fmt::format("{:.1f} s", r.end.time_s)
                              : fmt::format("{:.1f} s, {:.0f} times real time", r.end.time_s,
                                            r.end.realtime_factor));
  if (r.realtime) t += realtime_table(*r.realtime);
  return t;
}

std::string summary_json(const RunResult& r, const RunInfo& info) {
  using Json = nlohmann::ordered_json;
  const RunFigures& f = r.figures;
  Json j;
  j["version"] = SANDRUNNER_VERSION;
  j["commit"] = build_commit();
  j["policy"] = info.policy.empty() ? Json() : Json(info.policy);
  j["terrain"] = info.terrain;
  j["clock"] = info.clock;
  j["seed"] = info.seed;
  j["survived"] = r.survived && !r.has_truth ? Json() : Json(r.survived);
  j["fall_time_s"] = r.fall_time_s ? Json(*r.fall_time_s) : Json();
  j["fall_reason"] = r.survived ? Json() : Json(r.fall_reason);
  j["fall_mode"] = r.fall_mode ? Json(mode_name(*r.fall_mode)) : Json();
  j["fault_joints"] = joints_in(r.end.gate.fault_joints, r.record.scene.robot);
  j["interrupted"] = r.interrupted;
  j["duration_s"] = r.walked_s;
  j["command"] = info.command;
  const std::optional<double> followed = f.followed();
  j["followed"] = followed ? Json(*followed) : Json();
  if (f.motion) {
    const MotionFigures& m = *f.motion;
    j["mean_velocity_mps"] = m.mean_velocity_mps;
    j["mean_yaw_rate_radps"] = m.mean_yaw_rate_radps;
    j["sinkage_mm"] = {{"mean", 1e3 * m.sinkage_mean_m}, {"max", 1e3 * m.sinkage_max_m}};
    j["foot_clearance_iqr_mm"] = 1e3 * m.foot_clearance_iqr_m;
    j["cost_of_transport"] = m.cost_of_transport ? Json(*m.cost_of_transport) : Json();
  }
  j["mechanical_power_w"] = f.mechanical_power_w;
  j["torque_squared_nm2"] = f.torque_squared_nm2;
  j["estimator"] = f.estimate ? Json{{"velocity_rmse_mps", f.estimate->velocity_rmse_mps},
                                     {"body_height_rmse_m", f.estimate->body_height_rmse_m},
                                     {"foot_height_rmse_m", f.estimate->foot_height_rmse_m}}
                              : Json();
  j["joint_limit_steps"] = f.joint_limit_steps;
  j["speed_limit_steps"] = f.speed_limit_steps;
  for (const GateCounterName& counter : kGateCounters) {
    j["gate_ticks"][counter.name] = r.end.gate.counters.*counter.ticks;
  }
  j["state_hash"] = fmt::format("{:016x}", r.end.state_hash);
  j["realtime_factor"] = r.end.realtime_factor;
  if (r.realtime) j["realtime"] = realtime_json(*r.realtime);
  // A file named on the command line may have a name that is not UTF-8.
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sandrunner
