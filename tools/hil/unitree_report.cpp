// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/hil/unitree_bench.h"

namespace sandrunner::hil {

std::string unitree_report_json(const UnitreeReport& r) {
  using Json = nlohmann::ordered_json;
  const auto number = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
  Json j;
  j["time_s"] = r.time_s;
  j["was_enabled"] = r.was_enabled;
  j["off_at_end"] = r.off_at_end;
  j["walk"] = {{"time_s", r.walked_s},
               {"mean_speed_mps", number(r.mean_speed_mps)},
               {"base_touched", r.base_touched}};
  j["distance_m"] = r.distance_m;
  j["states"] = r.states;
  j["commands"] = {{"taken", r.commands},
                   {"refused", r.refused},
                   {"refusal", r.refusal},
                   {"writers", r.writers},
                   {"longest_gap_ms", 1e3 * r.longest_gap_s}};
  for (const FaultFigures& f : r.faults) {
    j["faults"].push_back({{"fault", f.text},
                           {"damped_after_s", number(f.damped_after_s)},
                           {"limp_after_s", number(f.limp_after_s)},
                           {"largest_torque_nm", f.largest_torque_nm}});
  }
  j["late_longest_ms"] = 1e3 * r.late_longest_s;
  return j.dump(2) + "\n";
}

std::string unitree_report_lines(const UnitreeReport& r) {
  std::string lines = fmt::format("commands   {} taken, {} refused", r.commands, r.refused);
  if (r.refused > 0) lines += fmt::format(" ({})", r.refusal);
  lines +=
      fmt::format(", of {} programs, longest gap {:.2f} ms; {}\n", r.writers, 1e3 * r.longest_gap_s,
                  !r.was_enabled ? "never enabled"
                  : r.off_at_end ? "off"
                                 : "NOT off at the end");
  lines += fmt::format("states     {} sent\n", r.states);
  if (r.mean_speed_mps) {
    lines += fmt::format("walked     {:.1f} s, {:.3f} m/s in their second half{}\n", r.walked_s,
                         *r.mean_speed_mps, r.base_touched ? "; FELL" : "");
  }
  lines += fmt::format("distance   {:.2f} m in {:.1f} s\n", r.distance_m, r.time_s);
  for (const FaultFigures& f : r.faults) {
    const auto after = [](const char* what, const std::optional<double>& time_s) {
      return time_s ? fmt::format("{} after {:.1f} ms", what, 1e3 * *time_s)
                    : fmt::format("NOT {}", what);
    };
    lines += fmt::format("fault      {}: {}, {}, at most {:.1f} N m\n", f.text,
                         after("damped", f.damped_after_s), after("limp", f.limp_after_s),
                         f.largest_torque_nm);
  }
  return lines + fmt::format("bench      {:.1f} ms late at most\n", 1e3 * r.late_longest_s);
}

}  // namespace sandrunner::hil
