// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/lab.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "estimator/heading.h"

namespace sandrunner::study {
namespace {

Sample sample_of(const evaluate::ObservedStep& step, const sim::Terrain<float>& terrain,
                 double foot_radius_m) {
  const sim::RigidState<float>& x = step.state.rigid;
  const sim::Mat3<float> r = sim::rotation_matrix(x.orientation);
  Sample s;
  s.x_m = x.position.x;
  s.vx_mps =
      components_along(heading_direction<float>({r.r0.x, r.r1.x}), {x.velocity.x, x.velocity.y})[0];
  s.yaw_rate_radps = dot(r.r2, x.angular_velocity);
  for (int l = 0; l < kNumLegs; ++l) {
    s.foot_height_m[l] = static_cast<float>(step.truth.foot_height_m[l]);
    const sim::FootContact<float>& contact = step.state.feet[l];
    s.stance[l] = contact.active > 0.0f;
    s.on_patch[l] = s.stance[l] && contact.region > 0.0f;
    if (!s.stance[l]) continue;
    const sim::Ground<float>& ground = terrain.ground[static_cast<std::size_t>(contact.region)];
    const float depth = static_cast<float>(foot_radius_m) - s.foot_height_m[l];
    s.depth_m[l] = std::max(0.0f, sim::yielded_depth(ground, contact, depth));
  }
  for (int j = 0; j < kNumJoints; ++j) s.torque_nm[j] = static_cast<float>(step.torque_nm[j]);
  return s;
}

// Greatest |torque| of one kind of joint over the steady half of a run.
double peak_torque(const Ran& run, int joint_of_leg) {
  if (run.figures.fell) return evaluate::kNotDefined;
  double peak = 0.0;
  for (std::size_t i = run.samples.size() / 2; i < run.samples.size(); ++i) {
    for (int l = 0; l < kNumLegs; ++l) {
      const float torque = run.samples[i].torque_nm[kJointsPerLeg * l + joint_of_leg];
      peak = std::max(peak, static_cast<double>(std::fabs(torque)));
    }
  }
  return peak;
}

// Depth of hind over front stances in the last 0.5 s.
double hind_over_front(const Ran& run) {
  constexpr std::size_t kLast = kPolicyHz / 2;
  const std::size_t begin = run.samples.size() - std::min(run.samples.size(), kLast);
  double front = 0.0, hind = 0.0;
  for (std::size_t i = begin; i < run.samples.size(); ++i) {
    for (int l = 0; l < kNumLegs; ++l) (l < 2 ? front : hind) += run.samples[i].depth_m[l];
  }
  return front > 0.0 ? hind / front : evaluate::kNotDefined;
}

}  // namespace

Lab::Lab(const LabSettings& settings)
    : settings_(settings),
      study_({.runs = settings.runs, .grid_runs = 1, .seed = 1}, sim::load_raibo()) {}

evaluate::Trial Lab::trial(const sim::TerrainDescription& ground, const VelocityCommand& command) {
  evaluate::Trial trial;
  trial.terrain = study_.add(ground);
  trial.command.target = command;
  trial.latency_ticks = kLatency_ticks;
  trial.noise_scale = 1.0;
  return trial;
}

std::vector<evaluate::Trial> Lab::repeat(const evaluate::Trial& like) const {
  return study_.group("", "", like).trials;
}

std::vector<Ran> Lab::run(const Model& model, const std::vector<evaluate::Trial>& trials,
                          bool with_hidden) const {
  std::vector<Ran> runs(trials.size());
  const double foot_radius_m = robot().model.foot_radius_m;
  const auto observe = [&](std::size_t i, const evaluate::ObservedStep& step) {
    runs[i].samples.push_back(sample_of(step, *trials[i].terrain, foot_radius_m));
    if (!with_hidden) return;
    runs[i].hidden.push_back(step.memory.h);
    Estimate& e = runs[i].estimate.emplace_back();
    e[0] = static_cast<float>(step.estimate.body_height_m);
    for (int k = 0; k < 3; ++k) e[1 + k] = static_cast<float>(step.estimate.velocity_mps[k]);
    for (int l = 0; l < kNumLegs; ++l)
      e[4 + l] = static_cast<float>(step.estimate.foot_height_m[l]);
  };
  const std::vector<evaluate::TrialFigures> figures =
      evaluate::run_trials(study_.robot(), study_.foot(), model.policy.value(), trials,
                           {settings_.threads, true}, {}, observe);
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i].figures = figures[i];
  return runs;
}

std::vector<double> straight_commands() {
  std::vector<double> commands;
  for (int i = 1; i <= 8; ++i) commands.push_back(0.5 * i);
  return commands;
}

std::vector<double> stance_depths(const Ran& run, std::size_t begin, int first_leg, int last_leg) {
  std::vector<double> depths;
  for (int l = first_leg; l <= last_leg; ++l) {
    double deepest = 0.0;
    for (std::size_t i = begin; i < run.samples.size(); ++i) {
      const Sample& s = run.samples[i];
      if (s.stance[l]) deepest = std::max(deepest, static_cast<double>(s.depth_m[l]));
      // A foot that grazes the ground makes no stance.
      if (!s.stance[l] && deepest > 1e-3) depths.push_back(deepest);
      if (!s.stance[l]) deepest = 0.0;
    }
  }
  return depths;
}

double mean_speed(const Ran& run, double from_m, double to_m) {
  std::vector<double> speeds;
  for (const Sample& s : run.samples) {
    if (s.x_m >= from_m && s.x_m < to_m) speeds.push_back(s.vx_mps);
  }
  return mean_of(speeds);
}

RunGroup straight_group(const std::string& ground, double command, const std::vector<Ran>& runs) {
  RunGroup group{ground, "", command, {}, {}};
  const auto put = [&](const char* name, double value) { group.runs[name].push_back(value); };
  for (const Ran& run : runs) {
    const evaluate::TrialFigures& f = run.figures;
    put("reached", f.track_done);
    put("alive", !f.fell);
    put("limits_kept", f.track_limits_kept);
    put("stops_brief", f.track_stops_brief);
    put("failed_before_track", f.failed_before_track);
    put("speed_mps", f.track_speed_mps);
    put("end_speed_mps", f.track_end_speed_mps);
    put("cot", f.track_cot);
    put("iqr_m", f.clearance_iqr_m);
    put("iqr_least_m", f.least_clearance_iqr_m);
    put("iqr_greatest_m", f.greatest_clearance_iqr_m);
    put("extension_w", f.leg_extension_power_w);
    put("peak_hfe_nm", peak_torque(run, 1));
    put("peak_kfe_nm", peak_torque(run, 2));
    put("depth_m", mean_of(stance_depths(run, run.samples.size() / 2, 0, kNumLegs - 1)));
    put("hind_over_front", hind_over_front(run));
    put("velocity_rmse_mps", f.velocity_rmse_mps);
    put("body_height_rmse_m", f.body_height_rmse_m);
    put("foot_height_rmse_m", f.foot_height_rmse_m);
  }
  return group;
}

RunGroup turn_group(const std::string& ground, double command, const std::vector<Ran>& runs) {
  RunGroup group{ground, "turn", command, {}, {}};
  const auto put = [&](const char* name, double value) { group.runs[name].push_back(value); };
  for (const Ran& run : runs) {
    const evaluate::TrialFigures& f = run.figures;
    const double turned = command > 0.0 ? f.turned_rad : -f.turned_rad;
    put("alive", !f.fell);
    put("success", !f.fell && turned > std::numbers::pi);
    put("turned_rad", turned);
    put("yaw_rate_radps", command > 0.0 ? f.yaw_rate_radps : -f.yaw_rate_radps);
    put("cotu", f.turning_cot);
  }
  return group;
}

}  // namespace sandrunner::study
