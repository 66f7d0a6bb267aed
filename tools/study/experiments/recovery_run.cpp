// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/recovery_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

#include "rt/core/processor.h"
#include "rt/run/process_config.h"
#include "rt/run/run.h"
#include "rt/run/run_script.h"
#include "rt/run/scene.h"
#include "rt/telemetry/view/view_page.h"
#include "sim/simulator.h"

namespace sandrunner::study {
namespace {

constexpr double kStripFrom_m = 5.0, kStripTo_m = 5.3;
constexpr double kLast_s = 0.78;  // of the paper's pictures, after the touchdown
constexpr int kStarts = 16;
constexpr std::size_t kMostBytes = 3'000'000;

RunRecord run_over_strip(const Lab& lab, const Model& model, int seed) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, "dry-sand");
  ProcessConfig config = read_process_config(tree, &model.policy.value().spec(), &lab.robot());
  sim::TerrainDescription& ground = config.simulator.terrain;
  const sim::GroundParameters sand = ground.patches[0].ground;
  sim::GroundParameters loose = sand;
  loose.sigma_flat_npm3 *= 0.5;
  loose.sigma_cone_npm3 *= 0.5;
  ground.patches.push_back({kStripFrom_m, loose});
  ground.patches.push_back({kStripTo_m, sand});
  config.simulator.seed = static_cast<std::uint64_t>(seed);
  PolicyRunner policy(model.policy.value());
  sim::Simulator simulator(config.robot, config.simulator);
  const CommandSource command("2.5,0,0");
  RunScript script(command, {.walk_s = 5.0, .start_walking = true}, true);
  return run_in_lockstep({.robot = simulator,
                          .controller = config.controller,
                          .start = Mode::kWalk,
                          .policy = policy,
                          .op = script},
                         {.scene = scene_of(config, model.policy.value().spec().name)})
      .record;
}

bool on_strip(const RunRow& row, int leg) {
  const auto& stance = row.stance_m[static_cast<std::size_t>(leg)];
  return stance[2] > 0.0f && stance[0] >= kStripFrom_m && stance[0] < kStripTo_m;
}

}  // namespace

std::optional<RecoveryRun> find_recovery_run(const Lab& lab, const Model& model) {
  flush_denormals_to_zero();
  for (int seed = 0; seed < kStarts; ++seed) {
    RecoveryRun run{run_over_strip(lab, model, seed), -1.0, seed};
    bool right = false;
    for (const RunRow& row : run.record.rows) {
      if (run.met_s < 0.0 && on_strip(row, 0)) run.met_s = row.t_s;
      right = right || on_strip(row, 1);
    }
    const bool long_enough = run.met_s >= 0.0 && run.record.rows.back().t_s >= run.met_s + kLast_s;
    if (long_enough && !right) return run;
  }
  return std::nullopt;
}

Json recovery_curves(const RecoveryRun& run) {
  constexpr double kDegrees = 57.29577951308232;
  Json lists;
  for (const RunRow& row : run.record.rows) {
    const double t = row.t_s - run.met_s;
    if (t < -0.5 || t > 1.2) continue;
    const auto& q = row.orientation_wxyz;
    lists["t_s"].push_back(t);
    lists["vx_mps"].push_back(row.motion[0]);
    lists["roll_deg"].push_back(kDegrees * std::atan2(2.0 * (q[0] * q[1] + q[2] * q[3]),
                                                      1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2])));
    lists["pitch_deg"].push_back(
        kDegrees * std::asin(std::clamp(2.0 * (q[0] * q[2] - q[3] * q[1]), -1.0, 1.0)));
    lists["left_foot_mm"].push_back(-1e3 * row.penetration_m[0]);
    lists["right_foot_mm"].push_back(-1e3 * row.penetration_m[1]);
  }
  return lists;
}

std::string recovery_page(RecoveryRun run) {
  run.record.scene.note = fmt::format(
      "The left front foot meets loose sand at {:.2f} s: half of the stiffness from {} to {} m.",
      run.met_s, kStripFrom_m, kStripTo_m);
  return run_page(run.record, kMostBytes);
}

}  // namespace sandrunner::study
