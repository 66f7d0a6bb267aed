// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/metrics.h"

#include <cmath>
#include <stdexcept>

namespace sandrunner::evaluate {
namespace {

double rate(bool hit) { return hit ? 1.0 : 0.0; }

}  // namespace

const std::vector<Metric>& metrics() {
  using R = const TrialFigures&;
  constexpr Pooling kRate = Pooling::kRate, kMean = Pooling::kMean, kRms = Pooling::kRms;
  static const std::vector<Metric> all = {
      {"survival", "alive", 100.0, 1, kRate, [](R r) { return rate(!r.fell); }},
      {"disturbance_met", "met", 100.0, 1, kRate, [](R r) { return r.disturbance_met; }},
      {"track_success", "success", 100.0, 1, kRate, [](R r) { return rate(r.track_done); }},
      {"track_strict_success", "strict", 100.0, 1, kRate,
       [](R r) { return rate(r.track_done && r.track_limits_kept); }},
      {"track_speed_mps", "track m/s", 1.0, 2, kMean, [](R r) { return r.track_speed_mps; }},
      {"track_cot", "track CoT", 1.0, 2, kMean, [](R r) { return r.track_cot; }},
      {"track_end_speed_mps", "end m/s", 1.0, 2, kMean, [](R r) { return r.track_end_speed_mps; }},
      {"vx_mps", "vx m/s", 1.0, 2, kMean, [](R r) { return r.vx_mps; }},
      {"vy_mps", "vy m/s", 1.0, 2, kMean, [](R r) { return r.vy_mps; }},
      {"yaw_rate_radps", "wz rad/s", 1.0, 2, kMean, [](R r) { return r.yaw_rate_radps; }},
      {"drift_vy_mps", "|vy| m/s", 1.0, 3, kMean, [](R r) { return std::fabs(r.vy_mps); }},
      {"drift_yaw_radps", "|wz| rad/s", 1.0, 3, kMean,
       [](R r) { return std::fabs(r.yaw_rate_radps); }},
      {"horizontal_speed_mps", "|v| m/s", 1.0, 3, kMean,
       [](R r) { return r.horizontal_speed_mps; }},
      {"velocity_error_mps", "v err m/s", 1.0, 3, kMean, [](R r) { return r.velocity_error_mps; }},
      {"yaw_error_radps", "wz err rad/s", 1.0, 3, kMean, [](R r) { return r.yaw_error_radps; }},
      {"cot", "CoT", 1.0, 2, kMean, [](R r) { return r.cot; }},
      {"turning_cot", "CoTu", 1.0, 2, kMean, [](R r) { return r.turning_cot; }},
      {"power_w", "P_mech W", 1.0, 0, kMean, [](R r) { return r.power_w; }},
      {"torque_squared_nm2", "tau^2 N2m2", 1.0, 0, kMean, [](R r) { return r.torque_squared_nm2; }},
      {"clearance_iqr_m", "IQR mm", 1e3, 0, kMean, [](R r) { return r.clearance_iqr_m; }},
      {"least_clearance_iqr_m", "least IQR mm", 1e3, 0, kMean,
       [](R r) { return r.least_clearance_iqr_m; }},
      {"greatest_clearance_iqr_m", "greatest IQR mm", 1e3, 0, kMean,
       [](R r) { return r.greatest_clearance_iqr_m; }},
      {"leg_extension_power_w", "P_ext W", 1.0, 0, kMean,
       [](R r) { return r.leg_extension_power_w; }},
      {"turned_rad", "turned rad", 1.0, 2, kMean, [](R r) { return r.turned_rad; }},
      {"stride_hz", "stride Hz", 1.0, 2, kMean, [](R r) { return r.stride_hz; }},
      {"duty", "duty", 1.0, 2, kMean, [](R r) { return r.duty; }},
      {"body_height_m", "height m", 1.0, 3, kMean, [](R r) { return r.body_height_m; }},
      {"tilt_rms_rad", "tilt rad", 1.0, 3, kRms, [](R r) { return r.tilt_rms_rad; }},
      {"action_change_rad", "d action rad", 1.0, 3, kMean, [](R r) { return r.action_change_rad; }},
      {"too_fast_share", "too fast %", 100.0, 3, kMean, [](R r) { return r.too_fast_share; }},
      {"past_stop_share", "past stop %", 100.0, 3, kMean, [](R r) { return r.past_stop_share; }},
      {"torque_limit_share", "tau limit %", 100.0, 2, kMean,
       [](R r) { return r.torque_limit_share; }},
      {"joint_speed_max_radps", "max qd", 1.0, 1, kMean,
       [](R r) { return r.joint_speed_max_radps; }},
      {"velocity_rmse_mps", "est v m/s", 1.0, 3, kRms, [](R r) { return r.velocity_rmse_mps; }},
      {"body_height_rmse_m", "est z mm", 1e3, 1, kRms, [](R r) { return r.body_height_rmse_m; }},
      {"foot_height_rmse_m", "est feet mm", 1e3, 1, kRms, [](R r) { return r.foot_height_rmse_m; }},
  };
  return all;
}

const Metric& metric(std::string_view key) {
  for (const Metric& m : metrics()) {
    if (key == m.key) return m;
  }
  throw std::logic_error("no metric '" + std::string(key) + "'");
}

Estimate pool(const Metric& metric, const std::vector<TrialFigures>& runs) {
  std::vector<double> values;
  for (const TrialFigures& run : runs) values.push_back(metric.of_run(run));
  switch (metric.pooling) {
    case Pooling::kRate: {
      int hits = 0, n = 0;
      for (const double v : values) {
        hits += v > 0.5;
        n += !std::isnan(v);
      }
      return rate_interval(hits, n);
    }
    case Pooling::kMean:
      return mean_interval(values);
    case Pooling::kRms:
      break;
  }
  return rms_interval(values);
}

}  // namespace sandrunner::evaluate
