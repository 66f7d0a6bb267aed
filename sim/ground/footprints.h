// SPDX-License-Identifier: BSD-3-Clause
// A ground that remembers: what a foot has pressed down stays down for the next one. What it
// displaced lies around as a rim, and slopes steeper than the angle of repose slip; no grain is
// lost. The ground under a footprint is as strong as it was at that depth.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

#include "rt/core/messages.h"
#include "sim/lanes/lanes.h"

namespace sandrunner::sim {

/// Heights of the present surface over the undisturbed one, on a square of cells around the robot;
/// what leaves the square is forgotten. Fixed in size, without pointers: a copy is a snapshot.
class Footprints {
 public:
  static constexpr int kSide = 128;  ///< cells
  static constexpr double kCell_m = 0.02;
  static constexpr int kMost = 4 * kNumLegs;  ///< feet, or patches of feet

  /// A foot, or a patch of one, at the end of a step. `depth_m`: of its deepest point below the
  /// undisturbed surface.
  struct Step {
    bool in_contact = false;
    double x_m = 0.0, y_m = 0.0, depth_m = 0.0;
    double radius_m = 0.0;
    double repose = 0.0;  ///< tangent of the ground's angle of repose
    bool flat = false;    ///< its bottom; else a ball's
  };

  /// Height under a foot at x, y, m: while it is in contact, that on which it touched down.
  double height_under(int foot, bool in_contact, double x_m, double y_m) noexcept;
  /// To be told of every step of a foot: as it lifts off, it leaves its print where it was deepest.
  void follow(int foot, const Step& step) noexcept;
  /// The feet are elsewhere all at once, as their robot is put there: they leave no prints.
  void move_feet() noexcept;
  /// Moves the square to where the robot is; seldom, since it may leave the middle by a quarter.
  void keep_around(double x_m, double y_m) noexcept;

  /// Height at x, y, m; 0 outside of the square.
  double height_at(double x_m, double y_m) const noexcept;
  /// Of all that lies above the undisturbed surface, less what is missing below it, m^3.
  double volume_m3() const noexcept;

 private:
  struct Foot {
    double touched_m = 0.0;                      // height on which it touched down
    double x_m = 0.0, y_m = 0.0, depth_m = 0.0;  // where it was deepest since then
    std::uint32_t presses = 0;                   // 1: it is in contact
    std::uint32_t knows_touched = 0;             // 1: touched_m is so
  };

  bool holds(std::int64_t column, std::int64_t row) const noexcept;
  float& cell(std::int64_t column, std::int64_t row) noexcept;
  float cell_or_0(std::int64_t column, std::int64_t row) const noexcept;
  void press(const Foot& foot, const Step& step) noexcept;
  void slip(std::int64_t column, std::int64_t row, std::int64_t reach, double repose) noexcept;

  std::int64_t first_column_ = -kSide / 2, first_row_ = -kSide / 2;
  std::array<Foot, kMost> feet_;  // patch by patch
  std::array<float, static_cast<std::size_t>(kSide) * kSide> height_m_{};
};
static_assert(std::is_trivially_copyable_v<Footprints>);

/// Those of the robot in each lane; null: none.
template <typename S>
struct Prints {
  using Real = LaneScalar<S>;
  using Values = LaneValues<S>;
  std::array<Footprints*, std::tuple_size_v<Values>> of{};

  bool are_none() const noexcept {
    for (const Footprints* prints : of) {
      if (prints != nullptr) return false;
    }
    return true;
  }
  /// As Footprints::height_under; 0 without prints.
  S height_under(int foot, S in_contact, S x, S y) const noexcept {
    const auto active = std::bit_cast<Values>(in_contact);
    const auto xs = std::bit_cast<Values>(x), ys = std::bit_cast<Values>(y);
    Values height{};
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i] == nullptr) continue;
      height[i] = static_cast<Real>(of[i]->height_under(
          foot, active[i] > Real(0.0), static_cast<double>(xs[i]), static_cast<double>(ys[i])));
    }
    return std::bit_cast<S>(height);
  }
  /// As Footprints::follow; `in_contact`: 1 where the foot is.
  void follow(int foot, S in_contact, S x, S y, S depth, S radius, bool flat,
              S repose) const noexcept {
    const auto active = std::bit_cast<Values>(in_contact), depths = std::bit_cast<Values>(depth),
               xs = std::bit_cast<Values>(x), ys = std::bit_cast<Values>(y),
               radii = std::bit_cast<Values>(radius), slopes = std::bit_cast<Values>(repose);
    const auto number = [](Real value) { return static_cast<double>(value); };
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i] == nullptr) continue;
      of[i]->follow(foot, {.in_contact = active[i] > Real(0.0),
                           .x_m = number(xs[i]),
                           .y_m = number(ys[i]),
                           .depth_m = number(depths[i]),
                           .radius_m = number(radii[i]),
                           .repose = number(slopes[i]),
                           .flat = flat});
    }
  }
  void keep_around(S x, S y) const noexcept {
    const auto xs = std::bit_cast<Values>(x), ys = std::bit_cast<Values>(y);
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i] == nullptr) continue;
      of[i]->keep_around(static_cast<double>(xs[i]), static_cast<double>(ys[i]));
    }
  }
};

}  // namespace sandrunner::sim
