// SPDX-License-Identifier: BSD-3-Clause
#include "tools/python/robots.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "estimator/cost_of_transport.h"
#include "sim/ground/standing.h"
#include "sim/robot/inertia.h"
#include "sim/step/actuator.h"

namespace sandrunner::python {
namespace {

constexpr double kStandAbove_m = 0.002;  // on ground that is not level
constexpr int kMostTicks = 1'000'000;

template <typename Record>
void require_finite(const char* what, int robot, const Record& record) {
  static_assert(sizeof(Record) % sizeof(float) == 0);
  const auto values = std::bit_cast<std::array<float, sizeof(Record) / sizeof(float)>>(record);
  if (std::ranges::all_of(values, [](float v) { return std::isfinite(v); })) return;
  throw InputError(
      fmt::format("{}: found a number that is not finite at robot {}, expected none", what, robot));
}

[[noreturn]] void fail(const char* what, const std::string& found, int robot,
                       const std::string& expected) {
  throw InputError(
      fmt::format("{}: found {} at robot {}, expected {}", what, found, robot, expected));
}

void require_least(const char* what, int robot, const std::string& name, float found,
                   double least) {
  if (found >= static_cast<float>(least)) return;
  fail(what, fmt::format("{} = {}", name, found), robot, fmt::format("at least {}", least));
}

template <typename Values>
void require_least_of_all(const char* what, int robot, const std::string& name, const Values& found,
                          double least) {
  for (const float value : found) require_least(what, robot, name, value, least);
}

/// As the reader of a URDF requires it.
void require_body(int robot, const std::string& name, const sim::Body<float>& body) {
  require_least("model", robot, name + ".mass", body.mass, sim::kLeastMass_kg);
  const sim::Sym3<float>& m = body.inertia;
  if (sim::is_inertia_of_a_body({m.xx, m.xy, m.xz, m.yy, m.yz, m.zz})) return;
  fail("model",
       fmt::format("{}.inertia {} {} {} {} {} {}", name, m.xx, m.xy, m.xz, m.yy, m.yz, m.zz), robot,
       "one that a body can have");
}

void require_model(int robot, const sim::RobotModel<float>& m) {
  constexpr double kLeast = 1e-6;  // of what is to be above 0
  require_body(robot, "base", m.base);
  for (const auto& leg : m.legs) {
    require_body(robot, "legs.hip", leg.hip);
    require_body(robot, "legs.thigh", leg.thigh);
    require_body(robot, "legs.shank", leg.shank);
    for (const float sign : leg.sign) {
      if (std::fabs(sign) == 1.0f) continue;
      fail("model", fmt::format("legs.sign {}", sign), robot, "1 or -1, for each joint's axis");
    }
  }
  require_least_of_all("model", robot, "rotor_inertia", m.rotor_inertia, 0.0);
  require_least_of_all("model", robot, "friction_nm", m.friction_nm, 0.0);
  require_least_of_all("model", robot, "torque_limit_nm", m.torque_limit_nm, kLeast);
  require_least_of_all("model", robot, "speed_limit_radps", m.speed_limit_radps, kLeast);
  for (int j = 0; j < kNumJoints; ++j) {
    if (m.lower_rad[j] < m.upper_rad[j]) continue;
    fail("model", fmt::format("lower_rad = {} and upper_rad = {}", m.lower_rad[j], m.upper_rad[j]),
         robot, "the lower one first");
  }
  require_least("model", robot, "foot_radius_m", m.foot_radius_m, kLeast);
  require_least("model", robot, "foot_width_m", m.foot_width_m, 0.0);
  require_least("model", robot, "foot_length_m", m.foot_length_m, 0.0);
  if (m.foot_patches != 1.0f && m.foot_patches != 2.0f && m.foot_patches != 4.0f) {
    fail("model", fmt::format("foot_patches {}", m.foot_patches), robot, "that of its robot");
  }
  require_least("model", robot, "knee_radius_m", m.knee_radius_m, 0.0);
  require_least("model", robot, "shank_radius_m", m.shank_radius_m, 0.0);
  const auto& half = m.base_box_half_m;
  require_least_of_all("model", robot, "base_box_half_m", std::array{half.x, half.y, half.z},
                       kLeast);
}

void require_drive(int robot, const sim::BatchDrive<float>& d) {
  require_least("drive", robot, "kp", d.kp, 0.0);
  require_least("drive", robot, "kd", d.kd, 0.0);
  require_least("drive", robot, "torque_scale", d.torque_scale, 0.0);
  require_least_of_all("drive", robot, "stall_torque_nm", d.line.stall_torque_nm, 0.0);
  require_least_of_all("drive", robot, "inverse_no_load_speed", d.line.inverse_no_load_speed, 0.0);
  require_least_of_all("drive", robot, "heat_factor", d.heat_factor, 0.0);
}

sim::StepSettings settings_at(double step_hz) {
  if (!(step_hz >= 500.0 && step_hz <= 100'000.0)) {
    throw InputError(fmt::format("step_hz: found {}, expected 500 to 100000", step_hz));
  }
  sim::StepSettings settings;
  settings.dt_s = 1.0 / step_hz;
  return settings;
}

}  // namespace

Robots::Robots(const std::string& robot, int count, const std::string& ground,
               const std::vector<std::string>& settings, double step_hz, int threads)
    : robot_(sim::load_robot(robot)),
      foot_(sim::make_foot_profile({}, robot_.model)),
      batch_(checked("num_robots", count, 1, kMostRobots), foot_, settings_at(step_hz)),
      pool_(checked("threads", threads, 1, kMostThreads)),
      states_(static_cast<std::size_t>(count)),
      drives_(states_.size()),
      reports_(states_.size()),
      sums_(states_.size()),
      heights_(states_.size()),
      prints_(states_.size()) {
  std::vector<int> all;
  for (int r = 0; r < count; ++r) {
    batch_.set_model(r, sim::convert_model<float>(robot_.model));
    all.push_back(r);
  }
  set_ground(ground, settings, all);
  stand(all);
}

void Robots::require_robot(int robot) const {
  if (robot >= 0 && robot < batch_.size()) return;
  throw InputError(
      fmt::format("robots: found index {}, expected 0 to {}", robot, batch_.size() - 1));
}

void Robots::set_ground(const std::string& ground, const std::vector<std::string>& settings,
                        const std::vector<int>& robots) {
  const sim::TerrainDescription description = read_ground(ground, settings);
  const sim::TerrainDescription usual;
  if (description.foot_shape != usual.foot_shape ||
      description.hydraulic_factor != usual.hydraulic_factor) {
    throw InputError(
        "terrain: found another foot, expected that of the robot's file: a batch has one kind");
  }
  const auto terrain =
      sim::convert_terrain<float>(sim::make_terrain(description, foot_, robot_.model));
  for (const int r : robots) require_robot(r);
  for (const int r : robots) {
    batch_.set_terrain(r, terrain);
    auto& heights = heights_[static_cast<std::size_t>(r)];
    heights = description.shape.heights;
    batch_.set_heights(r, heights.get());
    auto& prints = prints_[static_cast<std::size_t>(r)];
    prints.reset(sim::keeps_footprints(terrain) ? new sim::Footprints : nullptr);
    batch_.set_footprints(r, prints.get());
    auto& state = states_[static_cast<std::size_t>(r)];
    state.feet = {};
    state.further_feet = {};
    batch_.set_state(r, state);
  }
}

void Robots::set_state(int robot, const sim::RobotState<float>& state) {
  require_robot(robot);
  require_finite("state", robot, state);
  for (int i = 0; i < sim::kMaxFootPatches * kNumLegs; ++i) {
    const float region = state.contact(i % kNumLegs, i / kNumLegs).region;
    if (region >= 0.0f && region < float(sim::kMaxRegions) && region == std::floor(region)) {
      continue;
    }
    throw InputError(fmt::format("state: found contacts.region = {} at robot {}, expected 0 to {}",
                                 region, robot, sim::kMaxRegions - 1));
  }
  const auto& o = state.rigid.orientation;
  const float length = std::sqrt(o.w * o.w + o.x * o.x + o.y * o.y + o.z * o.z);
  if (!(std::fabs(length - 1.0f) < 0.01f)) {
    fail("state", fmt::format("an orientation of length {}", length), robot, "1");
  }
  states_[static_cast<std::size_t>(robot)] = state;
  if (auto& prints = prints_[static_cast<std::size_t>(robot)]) prints->move_feet();
  batch_.set_state(robot, state);
}

void Robots::set_model(int robot, const sim::RobotModel<float>& model) {
  require_robot(robot);
  require_finite("model", robot, model);
  require_model(robot, model);
  batch_.set_model(robot, model);
}

void Robots::stand(const std::vector<int>& robots) {
  for (const int r : robots) require_robot(r);
  for (const int r : robots) {
    const auto i = static_cast<std::size_t>(r);
    sim::RobotState<float> state;
    sim::BatchDrive<float> drive;
    for (int j = 0; j < kNumJoints; ++j) {
      const auto nominal = static_cast<float>(robot_.nominal_rad[j]);
      state.rigid.q[j] = drive.target[j] = drive.target_before[j] = nominal;
    }
    const sim::Shape<float> shape = batch_.robot(r).terrain.shape;
    state.rigid.orientation = sim::square_on(shape);
    state.rigid.position.z = static_cast<float>(
        shape.uneven > 0.0f
            ? sim::standing_height(robot_.model, robot_.nominal_rad, shape,
                                   sim::Relief<float>{{heights_[i].get()}}, kStandAbove_m)
            : robot_.nominal_height_m);
    if (prints_[i]) *prints_[i] = {};
    drive.kp = static_cast<float>(robot_.stand_kp_nmprad);
    drive.kd = static_cast<float>(robot_.stand_kd_nmsprad);
    if (robot_.obeys_torque_speed_line) {
      drive.line = sim::drive_line<float>(robot_.torque_speed_line);
    }
    drive.heat_factor = heat_factors<float>(robot_.motor_constant_nmpsqrtw);
    states_[i] = state;
    drives_[i] = drive;
    reports_[i] = {};
    sums_[i] = {};
    batch_.set_state(r, state);
  }
}

void Robots::advance(int ticks) {
  checked("ticks", ticks, 1, kMostTicks);
  process_.require("Batch");
  for (int r = 0; r < batch_.size(); ++r) {
    require_finite("drive", r, drives_[static_cast<std::size_t>(r)]);
    require_drive(r, drives_[static_cast<std::size_t>(r)]);
  }
  pool_.run(batch_.packs(), [&](int pack, int) {
    const int first = pack * batch_.width(), end = std::min(first + batch_.width(), batch_.size());
    for (int r = first; r < end; ++r) batch_.set_drive(r, drives_[static_cast<std::size_t>(r)]);
    batch_.advance(pack, ticks);
    for (int r = first; r < end; ++r) {
      const auto i = static_cast<std::size_t>(r);
      states_[i] = batch_.state(r);
      reports_[i] = batch_.report(r);
      sums_[i] = batch_.sums(r);
    }
  });
}

std::vector<sim::RobotModel<float>> Robots::models() const {
  std::vector<sim::RobotModel<float>> models;
  for (int r = 0; r < batch_.size(); ++r) models.push_back(batch_.robot(r).model);
  return models;
}

}  // namespace sandrunner::python
