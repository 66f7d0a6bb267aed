// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/experiments/anchors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "rt/core/messages.h"
#include "sim/ground/ground.h"
#include "tools/evaluate/study.h"

namespace sandrunner::study {
namespace {

constexpr double kFootWidth_m = 0.025;
constexpr double kDiscWidth_m = 2.0 * kFootRadius_m;
constexpr double kStepHz = kControlHz;  // as the robot's step

constexpr double kBeadsStiffness = 1040.0;  // k/m, 1/s^2
constexpr double kBeadsDrag_m = 0.087;      // d1

sim::GroundParameters dry_sand() { return sim::terrain_preset("dry-sand").patches[0].ground; }

// Slope of log y over log x.
double exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a;
    sy += b;
    sxx += a * a;
    sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double ball_mass(double density_kgpm3, double diameter_m) {
  return density_kgpm3 * std::numbers::pi / 6.0 * diameter_m * diameter_m * diameter_m;
}

// Depth of a ball that falls by `drop_m` in all, from its start to its rest in the beads.
double depth_of_fall(double density_kgpm3, double diameter_m, double drop_m) {
  const Ball ball{diameter_m, ball_mass(density_kgpm3, diameter_m)};
  double depth_m = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double free_m = std::max(drop_m - depth_m, 1e-3);
    const double found =
        drop_ball(ball, glass_beads(), std::sqrt(2.0 * kGravity_mps2 * free_m)).depth_m;
    depth_m = 0.5 * (depth_m + found);
  }
  return depth_m;
}

void add_ball_drops(std::vector<Anchor>& all) {
  const char* const kSource = "Katsuragi and Durian 2007 (arXiv cond-mat/0703072), their force law";
  for (const double v : {0.5, 1.0, 2.0, 3.0, 4.0}) {
    const Stop theirs = katsuragi_durian(v), ours = drop_ball({}, glass_beads(), v);
    const std::string what = fmt::format("steel ball of 25.4 mm on glass beads, {} m/s", v);
    all.push_back({what, kSource, "final depth, mm", 1e3 * theirs.depth_m, 1e3 * ours.depth_m, 1});
    all.push_back({what, kSource, "stopping time, ms", 1e3 * theirs.time_s, 1e3 * ours.time_s, 1});
  }
}

void add_exponents(std::vector<Anchor>& all) {
  constexpr double kSteel = 7800.0, kDiameter_m = 0.0254, kFall_m = 0.3;
  const char* const kWhat = "balls dropped on glass beads";
  const char* const kSource = "Uehara, Ambroso, Ojha and Durian 2003 (PRL 90 194301)";
  std::vector<double> x, y;
  const auto add = [&](double at, double depth) {
    x.push_back(at);
    y.push_back(depth);
  };
  const auto finish = [&](const char* quantity, double published) {
    all.push_back({kWhat, kSource, quantity, published, exponent(x, y), 3});
    x.clear();
    y.clear();
  };
  for (const double density : {1200.0, 2500.0, 4500.0, 7800.0, 11300.0}) {
    add(density, depth_of_fall(density, kDiameter_m, kFall_m));
  }
  finish("exponent of the depth over the ball's density", 1.0 / 2.0);
  for (const double diameter : {0.0125, 0.019, 0.0254, 0.038, 0.05}) {
    add(diameter, depth_of_fall(kSteel, diameter, kFall_m));
  }
  finish("exponent over its diameter", 2.0 / 3.0);
  for (const double fall : {0.06, 0.1, 0.3, 0.6, 1.0}) {
    add(fall, depth_of_fall(kSteel, kDiameter_m, fall));
  }
  finish("exponent over the height of the drop", 1.0 / 3.0);
}

void add_plates(std::vector<Anchor>& all) {
  const double ours = 1e-6 * disc_stress_gradient(dry_sand(), 0.060);
  const char* const kSlow =
      "flat plate pushed down slowly; ours: preset dry-sand, deeper than 59 mm";
  const char* const kRft = "Li, Zhang and Goldman 2013 (arXiv 1303.7065), their fit at tilt 0";
  const char* const kQuantity = "stress gained per depth, MN/m\u00b3";
  all.push_back({kSlow, kRft, fmt::format("{}, loose poppy seeds", kQuantity), 0.254, ours, 3});
  all.push_back({kSlow, kRft, fmt::format("{}, close poppy seeds", kQuantity), 0.464, ours, 3});
  // p = (k_c/b + k_phi) z^n
  constexpr double kExponent = 1.1, kCohesive = 0.99e3, kFrictional = 1528e3;
  const auto add_disc = [&](const char* name, double radius_m, double depth_m) {
    const double published =
        (kCohesive / radius_m + kFrictional) * std::pow(depth_m, kExponent - 1.0);
    all.push_back({fmt::format("{} pushed down slowly; ours: preset dry-sand", name),
                   "Bekker's law with Wong's values for dry sand",
                   fmt::format("pressure over depth at {:.0f} mm, MN/m\u00b3", 1e3 * depth_m),
                   1e-6 * published, 1e-6 * disc_stress_per_depth(dry_sand(), depth_m, radius_m),
                   2});
  };
  for (const double depth : {0.010, 0.030, 0.060}) {
    add_disc("disc of 29.5 mm radius", kFootRadius_m, depth);
  }
  for (const double depth : {0.010, 0.030}) {
    add_disc("disc of 110 cm\u00b2, SpaceBok's flat foot", std::sqrt(0.0110 / std::numbers::pi),
             depth);
  }
}

void add_drag(std::vector<Anchor>& all) {
  // F = K z + lambda rho A v^2 for a plate of 16 mm; A taken as its part below the surface.
  constexpr double kStiffness = 580.0, kLambda = 1.1, kDensity = 900.0, kWidth_m = 0.016;
  constexpr double kDepth_m = 0.040, kSlow = 0.04, kFast = 0.64;
  const auto theirs = [&](double v) {
    return kStiffness * kDepth_m + kLambda * kDensity * kWidth_m * kDepth_m * v * v;
  };
  all.push_back({"plate dragged at 40 mm depth; ours: the robot's foot, preset dry-sand",
                 "Agarwal, Karsai, Goldman and Kamrin 2021 (Science Advances 7), their force law",
                 "force at 0.64 m/s over that at 0.04 m/s", theirs(kFast) / theirs(kSlow),
                 drag_force(dry_sand(), kDepth_m, kFast) / drag_force(dry_sand(), kDepth_m, kSlow),
                 3});
}

/// A disc of this radius and the ground as it acts on it.
struct Disc {
  Disc(const sim::GroundParameters& parameters, double radius_m)
      : profile(sim::fit_foot_profile(sim::FootShape::kDisc, radius_m, 0.0, 2.0)),
        ground(sim::derive_ground(parameters, profile, radius_m)) {}
  sim::FootProfile<double> profile;
  sim::Ground<double> ground;
};

// Pushed at this speed to a depth, the force of mud on a disc over s_u A.
double mud_factor(double depth_m, double speed_mps) {
  sim::GroundParameters mud;
  mud.kind = sim::GroundKind::kMud;
  mud.strength_gradient_papm = 0.0;
  const Disc disc(mud, kFootRadius_m);
  sim::FootContact<double> contact;
  double force = 0.0;
  for (double z = 0.0; z <= depth_m; z += speed_mps / kStepHz) {
    force = sim::foot_force(disc.ground, disc.profile, {.z = z, .v = speed_mps}, kStepHz, contact)
                .normal;
  }
  return force / (mud.strength_pa * disc.profile.area(depth_m));
}

void add_mud(std::vector<Anchor>& all) {
  constexpr double kSlow = 1e-4;
  for (const double widths : {0.1, 0.5, 1.0, 2.0}) {
    all.push_back({"disc pushed slowly into clay", "API RP 2GEO, their formula",
                   fmt::format("force over strength and area, {} widths deep", widths),
                   5.14 * (1.18 + 0.3 * std::atan(widths)),
                   mud_factor(widths * kDiscWidth_m, kSlow), 2});
  }
  all.push_back({"what was left in mud is pulled out", "Liu 1969 (NCEL R-635), T^-0.07",
                 "force in a tenth of the time; ours: 0.3 m/s over 0.03", std::pow(10.0, 0.07),
                 mud_factor(kDiscWidth_m, 0.3) / mud_factor(kDiscWidth_m, 0.03), 3});
}

void add_layers(std::vector<Anchor>& all) {
  struct Row {
    double friction_deg, widths;
  };
  constexpr double kLayer_m = 0.4;
  for (const Row& row : {Row{28, 1.68}, Row{30, 1.83}, Row{35, 2.32}, Row{40, 3.07}}) {
    sim::GroundParameters deep = dry_sand();
    deep.cone_angle_rad = (45.0 + 0.5 * row.friction_deg) * std::numbers::pi / 180.0;
    sim::GroundParameters layered = deep;
    layered.layer_depth_m = kLayer_m;
    double widths = 5.0;
    const auto felt = [&](double above_m) {
      return disc_stress_per_depth(layered, kLayer_m - above_m) >
             disc_stress_per_depth(deep, kLayer_m - above_m);
    };
    while (widths > 0.0 && !felt(widths * kDiscWidth_m)) widths -= 1e-3;
    all.push_back(
        {"footing on sand over a firmer layer",
         "Fundamentals of Foundation Engineering, eq. 5.35: the law's own source",
         fmt::format("felt from so many widths above it, friction {} degrees", row.friction_deg),
         row.widths, widths, 2});
  }
}

}  // namespace

std::vector<Anchor> ground_anchors() {
  std::vector<Anchor> all;
  add_ball_drops(all);
  add_exponents(all);
  add_plates(all);
  add_drag(all);
  add_layers(all);
  add_mud(all);
  return all;
}

sim::GroundParameters glass_beads() {
  constexpr double kBulk_kgpm3 = 1520.0;
  const Ball ball;
  const double area = std::numbers::pi / 4.0 * ball.diameter_m * ball.diameter_m;
  sim::GroundParameters g;
  g.packing = 0.59;
  g.grain_density_kgpm3 = kBulk_kgpm3 / g.packing;
  g.sigma_flat_npm3 = kBeadsStiffness * ball.mass_kg / area;
  // The cone's side is longer than the area that it stands on.
  g.sigma_cone_npm3 = g.sigma_flat_npm3 * std::cos(g.cone_angle_rad);
  return g;
}

Stop drop_ball(const Ball& ball, const sim::GroundParameters& parameters, double impact_mps) {
  // Of a sphere, the hydraulic radius is that of the disc that the surface cuts out.
  const sim::FootProfile<double> foot =
      sim::fit_foot_profile(sim::FootShape::kSphere, 0.5 * ball.diameter_m, 0.0, 2.0);
  const sim::Ground<double> ground = sim::derive_ground(parameters, foot, 0.5 * ball.diameter_m);
  sim::FootContact<double> contact;
  double z = 0.0, v = impact_mps, t = 0.0;
  while (v > 0.0) {
    const double force = sim::foot_force(ground, foot, {.z = z, .v = v}, kStepHz, contact).normal;
    v += (kGravity_mps2 - force / ball.mass_kg) / kStepHz;
    z += v / kStepHz;
    t += 1.0 / kStepHz;
  }
  return {z, t};
}

Stop katsuragi_durian(double impact_mps) {
  constexpr double kDt_s = 1e-6;
  Stop stop;
  for (double v = impact_mps; v > 0.0; stop.time_s += kDt_s) {
    v += kDt_s * (kGravity_mps2 - kBeadsStiffness * stop.depth_m - v * v / kBeadsDrag_m);
    stop.depth_m += kDt_s * v;
  }
  return stop;
}

double disc_stress_per_depth(const sim::GroundParameters& parameters, double depth_m,
                             double radius_m) {
  const Disc disc(parameters, radius_m);
  const double force = sim::quasistatic_force(disc.ground, disc.profile, depth_m);
  return force / (std::numbers::pi * radius_m * radius_m * depth_m);
}

double disc_stress_gradient(const sim::GroundParameters& parameters, double depth_m) {
  constexpr double kMore = 1e-4;
  const auto stress = [&](double z) { return z * disc_stress_per_depth(parameters, z); };
  return (stress(depth_m + kMore) - stress(depth_m)) / kMore;
}

double drag_force(const sim::GroundParameters& parameters, double depth_m, double speed_mps) {
  constexpr double kBeyond_m = 0.030, kDown_mps = 0.1;
  const sim::FootProfile<double> foot =
      sim::fit_foot_profile(sim::FootShape::kTyre, kFootRadius_m, kFootWidth_m, 4.0);
  const sim::Ground<double> ground = sim::derive_ground(parameters, foot, kFootRadius_m);
  sim::FootContact<double> contact;
  for (double z = 0.0; z < depth_m; z += kDown_mps / kStepHz) {
    sim::foot_force(ground, foot, {.z = z, .v = kDown_mps}, kStepHz, contact);
  }
  sim::FootForce<double> force;
  for (double x = 0.0; x < parameters.crater_radius_m + kBeyond_m; x += speed_mps / kStepHz) {
    force =
        sim::foot_force(ground, foot, {.x = x, .z = depth_m, .vx = speed_mps}, kStepHz, contact);
  }
  return force.friction_bound + force.stroke;
}

}  // namespace sandrunner::study
