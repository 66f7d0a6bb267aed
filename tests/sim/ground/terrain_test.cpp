// SPDX-License-Identifier: BSD-3-Clause
// Terrain as a person writes it: presets, patches, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "rt/base/errors.h"
#include "sim/ground/terrain_description.h"
#include "sim/simulator.h"
#include "tests/sim/support.h"
#include "tests/support/error_of.h"

namespace sandrunner::sim {
namespace {

TerrainDescription read(const std::string& toml) {
  ConfigTree config;
  config.add_text(toml, "my.toml");
  TerrainDescription t = read_terrain(config);
  config.reject_unknown();
  return t;
}

void expect_names(const std::string& toml, const std::string& key) {
  const std::string what = error_of([&] { read(toml); });
  EXPECT_NE(what.find(key), std::string::npos) << what;
}

TEST(TerrainTest, PresetsHaveTheirFigures) {
  const auto preset = [](const std::string& name) {
    ConfigTree config;
    add_terrain_layer(config, name);
    TerrainDescription t = read_terrain(config);
    config.reject_unknown();
    EXPECT_EQ(t.name, name);
    return t;
  };
  for (const std::string& name : terrain_preset_names()) preset(name);
  const GroundParameters sand = preset("dry-sand").patches[0].ground;
  EXPECT_EQ(sand.kind, GroundKind::kGranular);
  EXPECT_EQ(sand.sigma_flat_npm3, 1.0e6);
  EXPECT_EQ(sand.sigma_cone_npm3, 0.2e6);
  EXPECT_EQ(sand.friction, 0.8);
  // The rest: defaults of the authors' code.
  EXPECT_EQ(sand.recruitment, 2.0);
  EXPECT_NEAR(sand.cone_angle_rad, std::numbers::pi / 3.0, 1e-15);
  EXPECT_EQ(sand.mass_scaling, 2.7);
  EXPECT_EQ(sand.packing, 0.57);
  EXPECT_EQ(sand.grain_density_kgpm3, 1000.0);
  EXPECT_EQ(sand.drag, 17.2);
  EXPECT_EQ(sand.plastic_tolerance_m, 1e-4);
  EXPECT_EQ(sand.stroke_stiffness_npm, 160.0);
  EXPECT_EQ(sand.stroke_damping_nspm, 1.0);
  EXPECT_EQ(sand.crater_radius_m, 0.05);
  EXPECT_EQ(preset("rigid").patches[0].ground.kind, GroundKind::kRigid);
  EXPECT_EQ(preset("rigid").patches[0].ground.friction, 0.8);
  const GroundParameters mattress = preset("air-mattress").patches[0].ground;
  EXPECT_EQ(mattress.kind, GroundKind::kLinear);
  EXPECT_EQ(mattress.stiffness_npm, 750.0);
  EXPECT_EQ(mattress.coupling_npm, 170.0);
  EXPECT_EQ(mattress.damping_nspm, 60.0);
  EXPECT_EQ(preset("memory-foam").patches[0].ground.stiffness_npm, 900.0);
  EXPECT_EQ(preset("memory-foam").patches[0].ground.coupling_npm, 0.0);
  const TerrainDescription t = preset("dry-sand");
  EXPECT_EQ(t.foot_shape, FootShape::kTyre);
  EXPECT_EQ(t.hydraulic_factor, 0.0);  // 4 for a tyre
}

TEST(TerrainTest, PatchesTakeTheFirstGroundOrAPresetWithDifferences) {
  const TerrainDescription t = read(R"(
    [terrain]
    friction = 0.5
    sigma_flat_npm3 = 2e6
    effects.filter = false
    [[terrain.patch]]
    from_x_m = 1.0
    sigma_flat_npm3 = 3e6
    [[terrain.patch]]
    from_x_m = 2.5
    preset = "rigid"
    friction = 0.4
  )");
  ASSERT_EQ(t.patches.size(), 3u);
  EXPECT_EQ(t.patches[0].ground.sigma_flat_npm3, 2e6);
  EXPECT_EQ(t.patches[1].from_x_m, 1.0);
  EXPECT_EQ(t.patches[1].ground.sigma_flat_npm3, 3e6);
  EXPECT_EQ(t.patches[1].ground.friction, 0.5);
  EXPECT_FALSE(t.patches[1].ground.filter);
  EXPECT_EQ(t.patches[2].ground.kind, GroundKind::kRigid);
  EXPECT_EQ(t.patches[2].ground.friction, 0.4);
  EXPECT_TRUE(t.patches[2].ground.filter);
  const Robot robot = load_raibo();
  const Terrain<double> terrain = make_terrain(t, make_foot_profile(t, robot.model), robot.model);
  EXPECT_EQ(terrain.region_at(-50.0), 0.0);
  EXPECT_EQ(terrain.region_at(0.999), 0.0);
  EXPECT_EQ(terrain.region_at(1.0), 1.0);
  EXPECT_EQ(terrain.region_at(2.5), 2.0);
  EXPECT_EQ(terrain.region_at(1e6), 2.0);
}

TEST(TerrainTest, SlopeAndWavesAreOfAllPatches) {
  const TerrainDescription t = read(R"(
    [terrain]
    slope_deg = 10.0
    slope_heading_deg = 90.0
    roughness_m = 0.01
    [[terrain.patch]]
    from_x_m = 1.0
    preset = "rigid"
  )");
  const Robot robot = load_raibo();
  Shape<double> shape = make_terrain(t, make_foot_profile(t, robot.model), robot.model).shape;
  EXPECT_EQ(shape.uneven, 1.0);
  EXPECT_EQ(shape.roughness, 0.01);
  shape.roughness = 0.0;
  const Surface<double> surface = surface_at(shape, 5.0, 2.0);
  EXPECT_NEAR(surface.height, 2.0 * std::tan(10.0 * std::numbers::pi / 180.0), 1e-12);
  EXPECT_NEAR(surface.slope_x, 0.0, 1e-12);
  EXPECT_NEAR(shape.over_plane({5.0, 2.0, surface.height}), 0.0, 1e-12);
  expect_names("[terrain]\nslope_deg = 50", "slope_deg");
  expect_names("[[terrain.patch]]\nslope_deg = 5", "slope_deg");
}

TEST(TerrainTest, ABallFootStandsOnTheSameGroundAsTheTyre) {
  // What carries, over the area of the buried foot seen from above.
  const RobotModel<double> tyre = load_raibo().model;
  RobotModel<double> ball = tyre;
  ball.foot_width_m = 0.0;
  ball.foot_radius_m = 0.022;
  const auto carrying = [](const RobotModel<double>& model, double area_m2) {
    const double r_h = make_foot_profile(TerrainDescription{}, model).hydraulic_radius(0.1);
    return std::numbers::pi * r_h * r_h / area_m2;
  };
  EXPECT_NEAR(carrying(ball, std::numbers::pi * 0.022 * 0.022),
              carrying(tyre, 2.0 * tyre.foot_radius_m * tyre.foot_width_m), 0.01);
}

TEST(TerrainTest, RefusesBadValuesInOneLine) {
  expect_names("[terrain]\nstifness_npm = 3.0", "stifness_npm");
  expect_names("[terrain]\nkind = \"linear\"\nstiffness_npm = -5.0", "stiffness_npm");
  expect_names("[terrain]\nsigma_flat_npm3 = -1e6", "sigma_flat_npm3");
  expect_names("[terrain]\nsigma_cone_npm3 = nan", "sigma_cone_npm3");
  expect_names("[terrain]\nfriction = inf", "friction");
  expect_names("[terrain]\nfriction = \"high\"", "friction");
  expect_names("[terrain]\nkind = \"lava\"", "kind");
  expect_names("[terrain]\neffects.filter = 1", "filter");
  expect_names("[terrain]\nfoot.shape = \"ball\"", "shape");
  expect_names("[terrain]\nroughness_m = -0.01", "roughness_m");
  expect_names("[terrain]\n[terrain.effects]\nfiltre = true", "filtre");
  expect_names("[terrain\n", "my.toml");
  expect_names("[[terrain.patch]]\nfrom_x_m = 2.0\n[[terrain.patch]]\nfrom_x_m = 1.0", "from_x_m");
  expect_names("[[terrain.patch]]\nfrom_x_m = 2.0\n[[terrain.patch]]\nfrom_x_m = 2.0", "from_x_m");
  expect_names("[[terrain.patch]]\nfrom_x_m = nan", "from_x_m");
  expect_names("[[terrain.patch]]\nfrom_x_m = 1.0\npreset = \"lava\"", "lava");
  expect_names("[[terrain.patch]]\nfrom_x_m = 1.0\nfrictoin = 0.2", "frictoin");
  std::string many;
  for (int i = 0; i < kMaxRegions; ++i)
    many += "[[terrain.patch]]\nfrom_x_m = " + std::to_string(i) + ".0\n";
  expect_names(many, "patch");
  ConfigTree config;
  EXPECT_THROW(add_terrain_layer(config, "no-such-terrain"), InputError);
}

TEST(TerrainTest, SimulatorTableRefusesBadValues) {
  const auto refused = [](const std::string& toml) {
    ConfigTree config;
    config.add_text(toml, "my.toml");
    const std::string error = error_of([&] {
      read_simulator_config(config, load_raibo());
      config.reject_unknown();
    });
    return !error.empty();
  };
  EXPECT_FALSE(refused("[sim]\nsensor_delay_ticks = 63\n[sim.noise]\njoint_position_rad = 0.01"));
  EXPECT_TRUE(refused("[sim]\nsensor_delay_ticks = 64"));
  EXPECT_TRUE(refused("[sim]\nsensor_delay_ticks = -1"));
  EXPECT_TRUE(refused("[sim]\nactuator_delay_ticks = 1.5"));
  EXPECT_TRUE(refused("[sim.noise]\njoint_position_rad = -0.01"));
  EXPECT_TRUE(refused("[sim]\nsensor_delay = 1"));
}

TEST(RoughSurfaceTest, HasItsDeviationBoundAndGradient) {
  const Shape<double> shape = derive_shape(waves(0.02));
  Draw draw(1);
  double sum = 0.0, square = 0.0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double x = draw(-50.0, 50.0), y = draw(-50.0, 50.0), e = 1e-6;
    double h, dx, dy, a, b, unused;
    rough_surface(shape, x, y, h, dx, dy);
    sum += h;
    square += h * h;
    ASSERT_LE(std::fabs(h), shape.crest);
    if (i % 100 != 0) continue;
    rough_surface(shape, x + e, y, a, unused, unused);
    rough_surface(shape, x - e, y, b, unused, unused);
    EXPECT_NEAR(dx, (a - b) / (2 * e), 1e-8);
    rough_surface(shape, x, y + e, a, unused, unused);
    rough_surface(shape, x, y - e, b, unused, unused);
    EXPECT_NEAR(dy, (a - b) / (2 * e), 1e-8);
  }
  EXPECT_NEAR(sum / n, 0.0, 1e-3);
  EXPECT_NEAR(std::sqrt(square / n), 0.02, 0.001);
}

}  // namespace
}  // namespace sandrunner::sim
