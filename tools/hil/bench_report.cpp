// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace sandrunner::hil {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

std::string after(const char* what, const std::optional<double>& time_s) {
  return time_s ? fmt::format("{} after {:.2f} ms", what, 1e3 * *time_s)
                : fmt::format("NOT {}", what);
}

}  // namespace

bool BenchReport::all_off() const noexcept {
  return std::all_of(drives.begin(), drives.end(), [](const DriveFigures& d) { return d.off; });
}

std::string report_json(const BenchReport& r, const RobotDescription& robot) {
  Json j;
  j["time_s"] = r.time_s;
  j["was_enabled"] = r.was_enabled;
  j["all_off"] = r.all_off();
  j["walk"] = {{"time_s", r.walked_s},
               {"mean_speed_mps", number(r.mean_speed_mps)},
               {"base_touched", r.base_touched}};
  j["distance_m"] = r.distance_m;
  for (const FaultFigures& f : r.faults) {
    j["faults"].push_back({{"fault", f.text},
                           {"damped_after_s", number(f.damped_after_s)},
                           {"passive_after_s", number(f.passive_after_s)},
                           {"limp_after_s", number(f.limp_after_s)},
                           {"largest_torque_nm", f.largest_torque_nm}});
  }
  for (int i = 0; i < kNumJoints; ++i) {
    const DriveFigures& d = r.drives[i];
    j["drives"][robot.joint_names[i]] = {{"frames", d.frames},
                                         {"replies", d.replies},
                                         {"state", d.state},
                                         {"time_outs", d.time_outs},
                                         {"longest_gap_ms", 1e3 * d.longest_gap_s}};
  }
  j["imu"] = {{"packets", r.imu_packets}, {"not_taken", r.imu_not_taken}};
  j["answer_us"] = {{"mean", r.answer_mean_us}, {"longest", r.answer_longest_us}};
  j["late_longest_us"] = r.late_longest_us;
  return j.dump(2) + "\n";
}

std::string report_lines(const BenchReport& r, const RobotDescription& robot) {
  std::string lines;
  const DriveFigures& first = r.drives.front();
  std::uint64_t frames = 0, replies = 0, time_outs = 0;
  double gap_s = 0.0;
  for (const DriveFigures& d : r.drives) {
    frames += d.frames;
    replies += d.replies;
    time_outs += d.time_outs;
    gap_s = std::max(gap_s, d.longest_gap_s);
  }
  const bool same = std::all_of(r.drives.begin(), r.drives.end(),
                                [&](const DriveFigures& d) { return d.state == first.state; });
  lines += fmt::format("drives     {} frames, {} answered, {} time-outs, longest gap {:.2f} ms; ",
                       frames, replies, time_outs, 1e3 * gap_s);
  if (!r.was_enabled) lines += "never all enabled; ";
  if (same) {
    lines += fmt::format("all {}\n", first.state);
  } else {
    lines += "at the end";
    for (int i = 0; i < kNumJoints; ++i) {
      lines += fmt::format(" {} {}", robot.joint_names[i], r.drives[i].state);
    }
    lines += '\n';
  }
  lines += fmt::format("IMU        {} packets, {} not taken\n", r.imu_packets, r.imu_not_taken);
  if (r.mean_speed_mps) {
    lines += fmt::format("walked     {:.1f} s, {:.3f} m/s in their second half{}\n", r.walked_s,
                         *r.mean_speed_mps, r.base_touched ? "; FELL" : "");
  }
  lines += fmt::format("distance   {:.2f} m in {:.1f} s\n", r.distance_m, r.time_s);
  for (const FaultFigures& f : r.faults) {
    lines += fmt::format("fault      {}: {}, {}, {}, at most {:.1f} N m\n", f.text,
                         after("damped", f.damped_after_s), after("passive", f.passive_after_s),
                         after("limp", f.limp_after_s), f.largest_torque_nm);
  }
  lines += fmt::format(
      "bench      answers {:.0f} us after the kernel's receipt, {:.0f} at most; "
      "{:.0f} us late at most\n",
      r.answer_mean_us, r.answer_longest_us, r.late_longest_us);
  return lines;
}

}  // namespace sandrunner::hil
