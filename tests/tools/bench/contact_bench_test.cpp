// SPDX-License-Identifier: BSD-3-Clause
// The drops that are timed, and the program's `contact`.
#include "tools/bench/contact_bench.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text_match.h"

namespace sandrunner::bench {
namespace {

/// A drop without inertia of the ground, and DRFT's zeta such that the buried foot needs the same
/// force per depth in both models: zeta w r pi 0.564 = sigma_cone pi r_h^2 / cos(theta). The cone's
/// flat face is as stiff as its side.
Drop matching_drop(const sim::FootProfile<double>& foot, double sigma_npm3, double mass_kg,
                   double speed_mps) {
  Drop drop{};
  drop.mass_kg = mass_kg;
  drop.impact_speed_mps = speed_mps;
  sim::GroundParameters p;
  p.sigma_cone_npm3 = sigma_npm3;
  p.sigma_flat_npm3 = sigma_npm3 / std::cos(p.cone_angle_rad);
  p.inertial_drag = p.added_mass = false;
  drop.ground = sim::derive_ground(p, foot, kFootRadius_m);
  drop.medium.inertia = 0.0;
  drop.medium.stress_npm3 = sigma_npm3 * drop.ground.inverse_cos * foot.buried_radius *
                            foot.buried_radius / (0.564 * kFootWidth_m * kFootRadius_m);
  return drop;
}

TEST(ContactBenchTest, DroppedFootRestsNearTheConeModelsDepthOnMatchingGround) {
  const sim::FootProfile<double> foot = foot_profile();
  for (const double sigma_npm3 : {0.15e6, 0.3e6, 0.6e6}) {
    for (const double speed_mps : {0.3, 1.0, 2.0}) {
      const Drop drop = matching_drop(foot, sigma_npm3, 5.0, speed_mps);
      const double cone_m = drop_on_cone(foot, drop).final_m;
      EXPECT_NEAR(drop_on_drft(planar_foot(), drop).final_m, cone_m, 0.1 * cone_m)
          << sigma_npm3 << " " << speed_mps;
    }
  }
}

TEST(ContactBenchTest, DrftTakesTheEnergyThatTheMassLoses) {
  // What the ground takes is what the mass loses on its way to rest: m (v^2/2 + g z) = int F dz.
  const sim::FootProfile<double> foot = foot_profile();
  const PlanarDrft drft = planar_foot();
  const Drop drop = matching_drop(foot, 0.3e6, 5.0, 1.5);
  const double depth_m = drop_on_drft(drft, drop).final_m;
  BodyMotion m;
  m.velocity_mps.z = -1.0;
  double work_j = 0.0;
  constexpr int kPanels = 2000;
  for (int i = 0; i < kPanels; ++i) {
    m.depth_m = depth_m * (i + 0.5) / kPanels - kFootRadius_m;
    work_j += drft.wrench(drop.medium, m).force_n.z * depth_m / kPanels;
  }
  EXPECT_NEAR(work_j, 5.0 * (0.5 * 1.5 * 1.5 + 9.81 * (depth_m + 1e-3)), 0.01 * work_j);
}

TEST(ContactBenchTest, DrftHoldsAFootAtRest) {
  const sim::FootProfile<double> foot = foot_profile();
  const auto check = [&](const auto& drft) {
    const Depths d = drop_on_drft(drft, random_drop(7, foot));
    EXPECT_GT(d.final_m, 0.02);
    EXPECT_EQ(d.final_m, d.before_m);
  };
  check(planar_foot());
  check(spatial_foot());
}

TEST(ContactBenchTest, PlanarAndSpatialDrftAgreeOnTheFoot) {
  // Two fits to the same kind of ground, on a foot that goes straight down.
  const sim::FootProfile<double> foot = foot_profile();
  for (std::uint64_t i = 0; i < 10; ++i) {
    const Drop drop = random_drop(i, foot);
    const double planar_m = drop_on_drft(planar_foot(), drop).final_m;
    EXPECT_NEAR(drop_on_drft(spatial_foot(), drop).final_m, planar_m, 0.25 * planar_m);
  }
}

TEST(ContactBenchTest, BothFeetHaveFourHundredElements) {
  EXPECT_EQ(planar_foot().size(), 400);
  EXPECT_EQ(spatial_foot().size(), 400);
}

TEST(ContactBenchTest, RatioIsTimeOverTheConesTimeInTheSameRound) {
  // One round, so that medians are the round's own values. How large they are is the machine's.
  const Report report = run_contact_bench(1, 20);
  std::map<std::string, Quartiles> rates(report.rates.begin(), report.rates.end());
  std::map<std::string, Quartiles> ratios(report.ratios.begin(), report.ratios.end());
  ASSERT_EQ(rates.size(), 3u);
  ASSERT_EQ(ratios.size(), 2u);
  for (const std::string name : {"drft", "drft_planar"}) {
    const Quartiles& ratio = ratios.at(name + "_vs_cone");
    EXPECT_EQ(ratio.runs, 1u) << name;
    EXPECT_GT(ratio.median, 0.0) << name;
    EXPECT_DOUBLE_EQ(ratio.median, rates.at("cone").median / rates.at(name).median) << name;
  }
}

TEST(ReportTest, PrintsAndWritesEveryFigure) {
  const Report report{.facts = {{"drops", "20"}},
                      .rates = {{"cone", {8.0, 6.0, 10.0, 3}}},
                      .ratios = {{"drft_vs_cone", {20.5, 19.0, 22.0, 3}}}};
  testing::internal::CaptureStdout();
  print(report);
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_NE(text.find("drops       20\n"), std::string::npos) << text;
  EXPECT_EQ(matches_in(text, "cone +8 +6 +10 +3\n").size(), 1u) << text;
  EXPECT_EQ(matches_in(text, "drft_vs_cone +20.500 +19.000 +22.000 +3\n").size(), 1u) << text;
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json, nlohmann::json::parse(R"({"drops": "20",
      "drft_vs_cone": {"median": 20.5, "q1": 19.0, "q3": 22.0, "runs": 3},
      "rates": {"cone": {"median": 8.0, "q1": 6.0, "q3": 10.0, "runs": 3}}})"));
}

int exit_code(const std::string& arguments) {
  return run_shell("'" SANDRUNNER_BENCH_PROGRAM "' " + arguments).code;
}

TEST(ContactBenchTest, ProgramRefusesBadInput) {
  EXPECT_EQ(exit_code("contact --rounds 0"), 2);
  EXPECT_EQ(exit_code("contact --json " + testing::TempDir()), 2);
  EXPECT_EQ(exit_code("contact --drops 5"), 2);
  EXPECT_EQ(exit_code("learner --rounds 0"), 2);
  EXPECT_EQ(exit_code("unitree --hardware " SANDRUNNER_CAN_EXAMPLE), 2);
}

}  // namespace
}  // namespace sandrunner::bench
