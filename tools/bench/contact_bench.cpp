// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/contact_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "rt/base/processor_name.h"
#include "rt/core/processor.h"
#include "sim/lanes/random.h"
#include "sim/robot/dynamics.h"
#include "tools/bench/clock.h"

namespace sandrunner::bench {
namespace {

constexpr double kStartHeight_m = 1e-3;  // above the surface
constexpr int kStepsBefore = 400;        // 0.1 s
constexpr double kRest_m = 1e-3;         // less than this in 0.1 s
constexpr int kDropsAtATime = 50;        // of one model before the next one's turn

}  // namespace

sim::FootProfile<double> foot_profile() {
  return sim::fit_foot_profile(sim::FootShape::kTyre, kFootRadius_m, kFootWidth_m, 4.0);
}

PlanarDrft planar_foot() { return PlanarDrft(cylinder_rim(kFootRadius_m, kFootWidth_m, 400, 1)); }

SpatialDrft spatial_foot() {
  std::vector<SurfaceElement> elements = cylinder_rim(kFootRadius_m, kFootWidth_m, 40, 5);
  for (const double side : {-1.0, 1.0}) {
    const auto end = cylinder_end(kFootRadius_m, kFootWidth_m, 5, 20, side);
    elements.insert(elements.end(), end.begin(), end.end());
  }
  return SpatialDrft(elements);
}

Drop random_drop(std::uint64_t index, const sim::FootProfile<double>& foot) {
  std::uint64_t counter = 0;
  const auto draw = [&](double low, double high) {
    return low + (high - low) * sim::random_uniform(1, index, counter++);
  };
  Drop drop{};
  drop.mass_kg = draw(2.5, 10.0);
  drop.impact_speed_mps = std::sqrt(2.0 * kGravity_mps2 * draw(0.02, 0.25));
  sim::GroundParameters p;
  p.sigma_flat_npm3 = draw(1e6, 10e6);
  p.sigma_cone_npm3 = draw(0.15e6, 0.6e6);
  p.grain_density_kgpm3 = draw(800.0, 2700.0);
  p.packing = draw(0.55, 0.63);
  p.recruitment = draw(1.5, 2.5);
  p.cone_angle_rad = draw(55.0, 66.0) * 3.14159265358979323846 / 180.0;
  p.mass_scaling = draw(1.5, 3.5);
  p.drag = std::min(draw(3.0, 20.0),
                    6e4 / (p.mass_scaling * p.packing * p.grain_density_kgpm3 * p.recruitment));
  drop.ground = sim::derive_ground(p, foot, kFootRadius_m);
  drop.medium.stress_npm3 = p.sigma_cone_npm3 * drop.ground.inverse_cos;
  drop.medium.density_kgpm3 = p.packing * p.grain_density_kgpm3;
  return drop;
}

Depths drop_on_cone(const sim::FootProfile<double>& foot, const Drop& drop) noexcept {
  sim::FootContact<double> contact;
  const double inverse_mass = 1.0 / drop.mass_kg;
  double z = -kStartHeight_m, v = drop.impact_speed_mps, before = 0.0;
  for (int i = 0; i < kDropSteps; ++i) {
    if (i == kDropSteps - kStepsBefore) before = z;
    const double force =
        sim::foot_force(drop.ground, foot,
                        {drop.x_m, drop.y_m, z, v, drop.slip_mps.x, drop.slip_mps.y},
                        1.0 / kDropStep_s, contact)
            .normal;
    v += kDropStep_s * (kGravity_mps2 - force * inverse_mass);
    z += kDropStep_s * v;
  }
  return {z, before};
}

template <typename Drft>
Depths drop_on_drft(const Drft& foot, const Drop& drop) noexcept {
  const double inverse_mass = 1.0 / drop.mass_kg;
  BodyMotion motion;
  motion.velocity_mps = drop.slip_mps;
  motion.spin_radps = drop.spin_radps;
  double z = -kStartHeight_m, v = drop.impact_speed_mps, before = 0.0;
  for (int i = 0; i < kDropSteps; ++i) {
    if (i == kDropSteps - kStepsBefore) before = z;
    const double free = v + kDropStep_s * kGravity_mps2;
    motion.depth_m = z - kFootRadius_m;
    motion.velocity_mps.z = -free;
    const double with_force =
        free - kDropStep_s * (foot.wrench(drop.medium, motion).force_n.z * inverse_mass);
    v = free > 0.0 ? std::max(with_force, 0.0) : std::min(with_force, 0.0);
    z += kDropStep_s * v;
  }
  return {z, before};
}
template Depths drop_on_drft(const PlanarDrft&, const Drop&) noexcept;
template Depths drop_on_drft(const SpatialDrft&, const Drop&) noexcept;

Report run_contact_bench(int rounds, int drops) {
  flush_denormals_to_zero();
  const sim::FootProfile<double> foot = foot_profile();
  const PlanarDrft planar = planar_foot();
  const SpatialDrft spatial = spatial_foot();
  std::vector<Drop> cases;
  for (int i = 0; i < drops; ++i) cases.push_back(random_drop(static_cast<std::uint64_t>(i), foot));

  Samples depths_mm, rates;
  for (int round = 0; round < rounds; ++round) {
    std::map<std::string, double> time_s;
    depths_mm.clear();
    const auto time = [&](const char* name, int first, auto&& fall) {
      const int last = std::min(first + kDropsAtATime, drops);
      std::vector<Depths> depths(static_cast<std::size_t>(last - first));
      time_s[name] += cpu_time_s([&] {
        for (int i = first; i < last; ++i) depths[i - first] = fall(cases[i]);
      });
      for (const Depths& d : depths) {
        if (!(std::fabs(d.final_m - d.before_m) < kRest_m)) {
          throw std::runtime_error(fmt::format(
              "{}: a drop of {} to {} is at {:.1f} mm and was at {:.1f} mm 0.1 s before", name,
              first, last - 1, 1e3 * d.final_m, 1e3 * d.before_m));
        }
        depths_mm[name].push_back(1e3 * d.final_m);
      }
    };
    for (int first = 0; first < drops; first += kDropsAtATime) {
      time("cone", first, [&](const Drop& d) { return drop_on_cone(foot, d); });
      time("drft", first, [&](const Drop& d) { return drop_on_drft(spatial, d); });
      time("drft_planar", first, [&](const Drop& d) { return drop_on_drft(planar, d); });
    }
    for (const auto& [name, s] : time_s) {
      rates[name].push_back(static_cast<double>(drops) * kDropSteps / s);
    }
  }

  Report report;
  const auto spread = [&](const char* name) {
    const Quartiles q = quartiles(depths_mm[name]);
    return fmt::format(
        "final depth {:.1f} (quartiles {:.1f} and {:.1f}), their range over it {:.2f}", q.median,
        q.q1, q.q3, (q.q3 - q.q1) / q.median);
  };
  const auto spread_against_cone = [&](const char* name) {
    const Quartiles c = quartiles(depths_mm["cone"]), d = quartiles(depths_mm[name]);
    return fmt::format("{}; against the cone's: depth {:+.0f} %, range {:+.0f} %", spread(name),
                       100.0 * (d.median / c.median - 1.0),
                       100.0 * ((d.q3 - d.q1) / (c.q3 - c.q1) - 1.0));
  };
  report.facts = {
      {"processor", processor_name()},
      {"drops", fmt::format("{}, each {} steps of 0.25 ms, random mass, fall and ground; one foot, "
                            "one core, double",
                            drops, kDropSteps)},
      {"cone", "ours, any motion in space; scalar"},
      {"drft", fmt::format("with the stresses of 3D-RFT, any motion in space; {} elements on rim "
                           "and ends, four at a time",
                           spatial.size())},
      {"planar", fmt::format("DRFT of 2021, motion in the foot's plane; {} elements on the rim, "
                             "four at a time",
                             planar.size())},
      {"cone_mm", spread("cone")},
      {"drft_mm", spread_against_cone("drft")},
      {"planar_mm", spread_against_cone("drft_planar")},
      {"clock", "processor time of the thread"}};
  for (const auto& [name, values] : rates) report.rates.emplace_back(name, quartiles(values));
  for (const char* name : {"drft", "drft_planar"}) {
    add_ratio(report, fmt::format("{}_vs_cone", name), rates, "cone", name);
  }
  return report;
}

}  // namespace sandrunner::bench
