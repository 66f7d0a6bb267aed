// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "tools/hil/bench.h"

namespace sandrunner::hil {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

std::string after(const char* what, const std::optional<double>& time_s) {
  return time_s ? fmt::format("{} after {:.2f} ms", what, 1e3 * *time_s)
                : fmt::format("NOT {}", what);
}

}  // namespace

std::string report_json(const BenchReport& r) {
  const Score& s = r.score;
  Json j;
  j["time_s"] = r.time_s;
  j["was_enabled"] = s.enabled_at_s.has_value();
  j["off_at_end"] = s.off_at_end;
  j["walk"] = {{"time_s", s.walked_s},
               {"mean_speed_mps", number(s.mean_speed_mps)},
               {"base_touched", s.base_touched}};
  if (!s.mean_speed_mps) j["walk"]["why_null"] = s.why_no_speed();
  j["distance_m"] = s.distance_m;
  for (const FaultFigures& f : s.faults) {
    j["faults"].push_back({{"fault", f.text},
                           {"damped_after_s", number(f.damped_after_s)},
                           {"passive_after_s", number(f.passive_after_s)},
                           {"limp_after_s", number(f.limp_after_s)},
                           {"largest_torque_nm", f.largest_torque_nm}});
    if (!f.limp_after_s) j["faults"].back()["why_null"] = "not until the end";
  }
  j.update(r.link.json);
  j["late_longest_ms"] = 1e3 * r.late_longest_s;
  return j.dump(2) + "\n";
}

std::string report_lines(const BenchReport& r) {
  const Score& s = r.score;
  std::string lines = r.link.lines;
  if (s.mean_speed_mps) {
    lines += fmt::format("walked     {:.1f} s, {:.3f} m/s in their second half{}\n", s.walked_s,
                         *s.mean_speed_mps, s.base_touched ? "; FELL" : "");
  }
  lines += fmt::format("distance   {:.2f} m in {:.1f} s\n", s.distance_m, r.time_s);
  for (const FaultFigures& f : s.faults) {
    lines += fmt::format("fault      {}: {}, {}, {}, at most {:.1f} N m\n", f.text,
                         after("damped", f.damped_after_s), after("passive", f.passive_after_s),
                         after("limp", f.limp_after_s), f.largest_torque_nm);
  }
  return lines +
         fmt::format("bench      {}{:.1f} ms late at most\n", r.link.bench, 1e3 * r.late_longest_s);
}

}  // namespace sandrunner::hil
