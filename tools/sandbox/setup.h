// SPDX-License-Identifier: BSD-3-Clause
// All that a run is made of, as bytes: the native program reads files and settings, the module of
// the page only the bytes. Both are little-endian and lay structs out alike; numbers of elements
// have 32 bits.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "policy/network_parameters.h"
#include "policy/perceptron.h"
#include "policy/policy.h"
#include "rt/core/controller.h"
#include "rt/core/robot_description.h"
#include "sim/ground/terrain_description.h"
#include "sim/robot/robot_model.h"
#include "sim/simulator.h"

namespace sandrunner::sandbox {

struct Setup {
  sim::Robot robot;  ///< without the texts of its files
  sim::SimulatorConfig simulator;
  ControllerConfig controller;       ///< of the run from the command line
  ControllerConfig page_controller;  ///< of the run that the page commands
  std::uint64_t stale_ticks = 0;     ///< RemoteOperator, of the page's commands
  LegJoints<double> motor_constant{};
  PolicySpec policy;  ///< what its steps need
  /// Empty: no policy.
  std::variant<std::monostate, NetworkParameters, PerceptronParameters> network;
  std::vector<sim::TerrainDescription> presets;  ///< that the page offers
};

// The members that are passed on, of each type that is not simply its bytes.
inline auto members(RobotFrame& f) {
  return std::tie(f.name, f.parent, f.translation_m, f.rotation_wxyz, f.joint, f.axis);
}
inline auto members(OutlinePoint& p) { return std::tie(p.frame, p.centre_m, p.radius_m); }
inline auto members(RobotDescription& d) {
  return std::tie(d.name, d.leg_names, d.joint_names, d.base_frame, d.frames, d.outline);
}
inline auto members(sim::Robot& r) {
  return std::tie(r.description, r.model, r.nominal_rad, r.nominal_height_m, r.lying_rad,
                  r.motor_constant_nmpsqrtw);
}
/// Without heights of a file, for which a page has no room.
inline auto members(sim::ShapeParameters& s) {
  return std::tie(s.slope_rad, s.slope_heading_rad, s.roughness_m, s.roughness_wavelength_m,
                  s.roughness_seed, s.dune_height_m, s.dune_length_m);
}
inline auto members(sim::TerrainDescription& t) {
  return std::tie(t.name, t.shape, t.patches, t.foot_shape, t.hydraulic_factor);
}
inline auto members(sim::SimulatorConfig& c) {
  return std::tie(c.terrain, c.noise, c.sensor_delay_ticks, c.actuator_delay_ticks,
                  c.torque_speed_line, c.step, c.seed);
}
inline auto members(PolicySpec& s) {
  return std::tie(s.name, s.nominal_position_rad, s.action_scale_rad, s.action_clip,
                  s.estimate_mean, s.estimate_variance);
}
inline auto members(DenseParameters& d) { return std::tie(d.weight, d.bias); }
inline auto members(NetworkParameters& p) {
  return std::tie(p.wiring, p.encoder_weight_ih, p.encoder_weight_hh, p.encoder_bias_ih,
                  p.encoder_bias_hh, p.encoder, p.estimator, p.actor, p.observation_mean,
                  p.observation_variance, p.observation_clip);
}
inline auto members(ObservationTerm& t) { return std::tie(t.kind, t.scale, t.clip, t.period_s); }
inline auto members(ObservationLayout& l) { return std::tie(l.terms, l.clip, l.history, l.order); }
inline auto members(PerceptronParameters& p) {
  return std::tie(p.policy_hz, p.observation, p.activation, p.joint_of, p.estimator, p.actor,
                  p.velocity_scale, p.estimator_layers, p.actor_layers);
}
inline auto members(Setup& s) {
  return std::tie(s.robot, s.simulator, s.controller, s.page_controller, s.stale_ticks,
                  s.motor_constant, s.policy, s.network, s.presets);
}

/// Appends to a text.
struct Writer {
  std::string bytes;

  void raw(void* from, std::size_t size) { bytes.append(static_cast<const char*>(from), size); }
  template <typename Elements>
  void resize(Elements& elements) {
    auto count = static_cast<std::uint32_t>(elements.size());
    raw(&count, sizeof count);
  }
  template <typename... Kinds>
  void choose(std::variant<Kinds...>& variant) {
    auto index = static_cast<std::uint32_t>(variant.index());
    raw(&index, sizeof index);
  }
};

/// Takes from the front of a text that a Writer made; traps at its end.
struct Reader {
  std::string_view bytes;

  void raw(void* to, std::size_t size) {
    if (size > bytes.size()) __builtin_trap();
    std::memcpy(to, bytes.data(), size);
    bytes.remove_prefix(size);
  }
  template <typename Elements>
  void resize(Elements& elements) {
    std::uint32_t count = 0;
    raw(&count, sizeof count);
    if (count > bytes.size()) __builtin_trap();  // none has less than a byte
    elements.resize(count);
  }
  template <typename... Kinds>
  void choose(std::variant<Kinds...>& variant) {
    std::uint32_t index = 0;
    raw(&index, sizeof index);
    std::uint32_t kind = 0;
    ((kind++ == index ? static_cast<void>(variant.template emplace<Kinds>()) : void()), ...);
  }
};

template <typename>
inline constexpr bool kIsVariant = false;
template <typename... Kinds>
inline constexpr bool kIsVariant<std::variant<Kinds...>> = true;

/// Writes or reads a value.
template <typename Stream, typename Value>
void pass(Stream& stream, Value& value) {
  if constexpr (std::is_same_v<Value, std::monostate>) {
    return;
  } else if constexpr (std::is_trivially_copyable_v<Value>) {
    stream.raw(&value, sizeof value);
  } else if constexpr (kIsVariant<Value>) {
    stream.choose(value);
    std::visit([&](auto& chosen) { pass(stream, chosen); }, value);
  } else if constexpr (requires { members(value); }) {
    std::apply([&](auto&... member) { (pass(stream, member), ...); }, members(value));
  } else {  // elements
    if constexpr (requires { value.resize(0); }) stream.resize(value);
    for (auto& element : value) pass(stream, element);
  }
}

/// `setup` as bytes, and back.
inline std::string to_bytes(Setup& setup) {
  Writer writer;
  pass(writer, setup);
  return std::move(writer.bytes);
}
inline Setup from_bytes(std::string_view bytes) {
  Reader reader{bytes};
  Setup setup;
  pass(reader, setup);
  if (!reader.bytes.empty()) __builtin_trap();
  return setup;
}

}  // namespace sandrunner::sandbox
