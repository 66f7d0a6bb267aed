// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_row.h"

#include <string_view>
#include <type_traits>

namespace sandrunner {
namespace {

template <typename T>
struct Element {
  using Type = T;
  static constexpr std::size_t kCount = 1;
};
template <typename T, std::size_t kSize>
struct Element<std::array<T, kSize>> : Element<T> {
  static constexpr std::size_t kCount = kSize * Element<T>::kCount;
};

template <typename Member>
constexpr RowField field(const char* name, std::size_t offset, const char* columns,
                         bool on_page = true) {
  using Type = typename Element<Member>::Type;
  static_assert(std::is_same_v<Type, double> || std::is_same_v<Type, float> ||
                std::is_same_v<Type, std::uint32_t>);
  const char* type = std::is_same_v<Type, double>  ? "f64"
                     : std::is_same_v<Type, float> ? "f32"
                                                   : "u32";
  return {name, type, offset, Element<Member>::kCount, columns, on_page};
}

// The compiler finds place, size and type of a member: a name cannot stand for another's values.
#define ROW(member, ...) \
  field<decltype(RunRow::member)>(#member, offsetof(RunRow, member), __VA_ARGS__)
#define FOOTPRINT(member) \
  field<decltype(Footprint::member)>(#member, offsetof(Footprint, member), "")

// clang-format off
constexpr bool kNotOnPage = false;
constexpr std::array kRowFields = {
    ROW(t_s, "t_s"),
    ROW(mode, "mode"),
    ROW(given, "command_vx_mps|command_vy_mps|command_wz_radps"),
    ROW(position_m, "base_{x,y,z}_m"),
    ROW(orientation_wxyz, "orientation_{w,x,y,z}"),
    ROW(odometry, "odometry_x_m|odometry_y_m|odometry_yaw_rad"),
    ROW(requested, "requested_vx_mps|requested_vy_mps|requested_wz_radps"),
    ROW(motion, "vx_mps|vy_mps|yaw_rate_radps"),
    ROW(mean_motion, "mean_vx_mps|mean_vy_mps|mean_yaw_rate_radps", kNotOnPage),
    ROW(position_rad, "{joint}_position_rad"),
    ROW(velocity_radps, "{joint}_velocity_radps"),
    ROW(torque_nm, "{joint}_torque_nm", kNotOnPage),
    ROW(peak_torque_nm, "{joint}_peak_torque_nm"),
    ROW(hip_m, "{leg}_hip_{x,y,z}_m", kNotOnPage),
    ROW(knee_m, "{leg}_knee_{x,y,z}_m", kNotOnPage),
    ROW(foot_m, "{leg}_foot_{x,y,z}_m", kNotOnPage),
    ROW(penetration_m, "{leg}_penetration_m"),
    ROW(ground_height_m, "{leg}_ground_height_m", kNotOnPage),
    ROW(contact, "{leg}_contact", kNotOnPage),
    ROW(foot_force_n, "{leg}_foot_force_{x,y,z}_n"),
    ROW(stance_m, "{leg}_stance_{x,y,depth}_m"),
    ROW(estimate, "estimate_body_height_m|estimate_velocity_{x,y,z}_mps|estimate_{leg}_foot_height_m"),
    ROW(truth, "truth_body_height_m|truth_velocity_{x,y,z}_mps|truth_{leg}_foot_height_m"),
    ROW(power_w, "power_w"),
    ROW(torque_squared_nm2, "torque_squared_nm2"),
    ROW(cost_of_transport, "cost_of_transport"),
    ROW(late_us, "late_us"),
    ROW(control_us, "control_us"),
    ROW(tick_us, "tick_us"),
    ROW(joint_past_stop, "joint_past_stop_ticks", kNotOnPage),
    ROW(joint_too_fast, "joint_too_fast_ticks", kNotOnPage),
    ROW(faults, "faults"),
    ROW(flags, "flags"),
    ROW(skipped, "skipped_ticks"),
};
// clang-format on
constexpr std::array kFootprintFields = {FOOTPRINT(t_s), FOOTPRINT(x_m), FOOTPRINT(y_m),
                                         FOOTPRINT(depth_m), FOOTPRINT(leg)};
#undef ROW
#undef FOOTPRINT

}  // namespace

std::size_t RowField::width() const noexcept {
  const std::string_view bits = type + 1;
  return bits == "64" ? 8 : bits == "32" ? 4 : 2;
}

std::span<const RowField> row_fields() { return kRowFields; }
std::span<const RowField> footprint_fields() { return kFootprintFields; }

}  // namespace sandrunner
