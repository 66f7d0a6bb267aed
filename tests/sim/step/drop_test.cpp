// SPDX-License-Identifier: BSD-3-Clause
// A point mass of 5 kg that falls on one foot: the granular law in time, against the independent
// simulation of the same model in tests/golden/granular.py (semi-implicit Euler, 2 s). The depths
// follow from the explicit reading of the added mass (acceleration by backward difference): at 0.5
// and 1 ms, where it begins to matter, another reading gives other ones.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/sim/ground/granular_foot.h"
#include "tests/support/csv.h"

namespace sandrunner::sim {
namespace {

constexpr double kMass_kg = 5.0;

struct Drop {
  double max_depth_m = 0.0, final_depth_m = 0.0, peak_force_n = 0.0;
  // Over the last second.
  double mean_force_n = 0.0, force_deviation_n = 0.0, creep_mps = 0.0;
};

struct DropSettings {
  double sigma_flat_mnpm3, sigma_cone_mnpm3;
  double centre_height_m;
  bool quasistatic = false;
  bool filter = true;
  double dt_s = 0.25e-3;
};

Drop drop(const DropSettings& s) {
  GroundParameters parameters;
  parameters.sigma_flat_npm3 = 1e6 * s.sigma_flat_mnpm3;
  parameters.sigma_cone_npm3 = 1e6 * s.sigma_cone_mnpm3;
  parameters.inertial_drag = parameters.added_mass = !s.quasistatic;
  parameters.filter = s.filter;
  Foot foot(parameters);
  if (s.filter) foot.ground.filter_step = 100.0 * s.dt_s;  // c_r = 100/f_sim at this rate
  Drop d;
  double z = kFootRadius_m - s.centre_height_m, v = 0.0;
  const int steps = static_cast<int>(std::lround(2.0 / s.dt_s)), half = steps / 2;
  double sum = 0.0, square = 0.0, first = 0.0, last = 0.0;
  const int window = steps / 20;  // 0.1 s: means over it do not see the limit cycle
  for (int i = 0; i < steps; ++i) {
    const double force =
        foot_force(foot.ground, foot.profile, {.z = z, .v = v}, 1.0 / s.dt_s, foot.contact).normal;
    EXPECT_GE(force, 0.0);
    d.peak_force_n = std::fmax(d.peak_force_n, force);
    if (i >= half) {
      sum += force;
      square += force * force;
      if (i < half + window) first += z / window;
      if (i >= steps - window) last += z / window;
    }
    v += s.dt_s * (kGravity_mps2 - force / kMass_kg);
    z += s.dt_s * v;
    d.max_depth_m = std::fmax(d.max_depth_m, z);
  }
  const int n = steps - half;
  d.final_depth_m = z;
  d.mean_force_n = sum / n;
  d.force_deviation_n = std::sqrt(square / n - d.mean_force_n * d.mean_force_n);
  d.creep_mps = (last - first) / 0.9;
  return d;
}

Drop drop(const CsvRow& row) {
  return drop({row.at("sigma_flat_mnpm3"), row.at("sigma_cone_mnpm3"), row.at("centre_height_m"),
               row.at("inertia") == 0.0, row.at("filter") == 1.0, row.at("dt_s")});
}

TEST(DropTest, DepthsAndPeakForcesMatchTheGoldenDrops) {
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/drop.csv")) {
    SCOPED_TRACE(testing::PrintToString(row));
    const Drop d = drop(row);
    EXPECT_NEAR(1e3 * d.max_depth_m, row.at("max_depth_mm"), 0.01);
    EXPECT_NEAR(d.peak_force_n, row.at("peak_force_n"), 1e-3 * row.at("peak_force_n"));
  }
}

TEST(DropTest, WithoutInertiaTheQuasistaticForceTakesAllOfTheFall) {
  for (const auto& [flat, cone] :
       {std::pair{1.0, 0.2}, std::pair{5.0, 0.4}, std::pair{10.0, 0.6}}) {
    for (const double height_m : {0.0, 0.05, 0.2}) {
      GroundParameters parameters;
      parameters.sigma_flat_npm3 = 1e6 * flat;
      parameters.sigma_cone_npm3 = 1e6 * cone;
      const Foot foot(parameters);
      double depth_m = 0.0, work_j = 0.0;
      do {
        work_j += 1e-6 * foot.quasistatic(depth_m + 0.5e-6);
        depth_m += 1e-6;
      } while (work_j < kMass_kg * kGravity_mps2 * (height_m + depth_m));
      DropSettings settings{flat, cone, kFootRadius_m + height_m, true, false, 0.05e-3};
      EXPECT_NEAR(drop(settings).max_depth_m, depth_m, 0.005 * depth_m) << flat << " " << height_m;
      if (height_m == 0.0) continue;
      settings.quasistatic = false;  // with inertia it takes less depth
      EXPECT_LT(drop(settings).max_depth_m, 0.99 * depth_m);
    }
  }
}

TEST(DropTest, DroppedMassComesToRestWithinThePlasticTolerance) {
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/drop.csv")) {
    if (row.at("filter") == 0.0 || row.at("dt_s") != 0.25e-3) continue;
    SCOPED_TRACE(testing::PrintToString(row));
    const Drop d = drop(row);
    EXPECT_NEAR(1e3 * d.final_depth_m, 1e3 * d.max_depth_m, 0.25);
    EXPECT_NEAR(d.mean_force_n, kMass_kg * kGravity_mps2, 0.01 * kMass_kg * kGravity_mps2);
    EXPECT_LT(std::fabs(d.creep_mps), 0.05e-3);
  }
}

TEST(DropTest, FilterQuietensTheForceAtRest) {
  // A limit cycle, which a last bit shifts: its strength is compared, not its course.
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/drop.csv")) {
    if (row.at("filter") == 1.0) continue;
    SCOPED_TRACE(testing::PrintToString(row));
    CsvRow filtered = row;
    filtered["filter"] = 1.0;
    const double deviation_n = drop(row).force_deviation_n;
    EXPECT_NEAR(deviation_n, row.at("force_deviation_n"), 0.05 * row.at("force_deviation_n"));
    EXPECT_LT(drop(filtered).force_deviation_n, 0.7 * deviation_n);
  }
}

TEST(DropTest, SlowLoadingSinksToTheStaticDepth) {
  // The mass is lowered: a damper in parallel with the ground, heavy enough that inertia and drag
  // do not count, leaves F_p(z) = m g.
  for (const CsvRow& row : read_csv(SANDRUNNER_GOLDEN_DIR "/static_depth.csv")) {
    SCOPED_TRACE(testing::PrintToString(row));
    const double mass_kg = row.at("force_n") / kGravity_mps2;
    GroundParameters parameters;
    parameters.sigma_flat_npm3 = 1e6 * row.at("sigma_flat_mnpm3");
    parameters.sigma_cone_npm3 = 1e6 * row.at("sigma_cone_mnpm3");
    Foot foot(parameters);
    double z = -0.001, v = 0.0;
    for (int n = 0; n < 80000; ++n) {
      const double force = foot.step({.z = z, .v = v}).normal;
      v = (v + kDt_s * (kGravity_mps2 - force / mass_kg)) / (1.0 + kDt_s * 200.0);
      z += kDt_s * v;
    }
    EXPECT_NEAR(1e3 * z, row.at("depth_mm"), 0.1);
  }
}

}  // namespace
}  // namespace sandrunner::sim
