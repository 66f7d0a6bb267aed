// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/footprints.h"

#include <algorithm>
#include <cmath>

namespace sandrunner::sim {
namespace {

// A robot that has diverged is anywhere.
std::int64_t cell_of(double at_m) noexcept {
  if (!(std::fabs(at_m) < 1e6)) return 0;
  return static_cast<std::int64_t>(std::floor(at_m / Footprints::kCell_m));
}
double middle_of(std::int64_t cell) noexcept {
  return (static_cast<double>(cell) + 0.5) * Footprints::kCell_m;
}
std::size_t in_ring(std::int64_t cell) noexcept {
  return static_cast<std::size_t>(cell) % Footprints::kSide;
}

}  // namespace

bool Footprints::holds(std::int64_t column, std::int64_t row) const noexcept {
  return column >= first_column_ && column < first_column_ + kSide && row >= first_row_ &&
         row < first_row_ + kSide;
}

float& Footprints::cell(std::int64_t column, std::int64_t row) noexcept {
  return height_m_[in_ring(row) * kSide + in_ring(column)];
}

float Footprints::cell_or_0(std::int64_t column, std::int64_t row) const noexcept {
  return holds(column, row) ? height_m_[in_ring(row) * kSide + in_ring(column)] : 0.0f;
}

double Footprints::height_at(double x_m, double y_m) const noexcept {
  if (!(std::fabs(x_m) < 1e6 && std::fabs(y_m) < 1e6)) return 0.0;
  const double u = x_m / kCell_m - 0.5, v = y_m / kCell_m - 0.5;
  const double column = std::floor(u), row = std::floor(v), fx = u - column, fy = v - row;
  const auto i = static_cast<std::int64_t>(column), j = static_cast<std::int64_t>(row);
  const auto along_x = [&](std::int64_t in_row) {
    return (1.0 - fx) * static_cast<double>(cell_or_0(i, in_row)) +
           fx * static_cast<double>(cell_or_0(i + 1, in_row));
  };
  return (1.0 - fy) * along_x(j) + fy * along_x(j + 1);
}

double Footprints::height_under(int number, bool in_contact, double x_m, double y_m) noexcept {
  Foot& foot = feet_[static_cast<std::size_t>(number)];
  if (!in_contact || foot.knows_touched == 0) foot.touched_m = height_at(x_m, y_m);
  foot.knows_touched = 1;
  return foot.touched_m;
}

void Footprints::follow(int number, const Step& step) noexcept {
  Foot& foot = feet_[static_cast<std::size_t>(number)];
  if (!step.in_contact) {
    if (foot.presses != 0) press(foot, step);
    foot.presses = 0;
    return;
  }
  if (foot.presses == 0 || step.depth_m > foot.depth_m) {
    foot.x_m = step.x_m;
    foot.y_m = step.y_m;
    foot.depth_m = step.depth_m;
  }
  foot.presses = 1;
}

void Footprints::keep_around(double x_m, double y_m) noexcept {
  const std::int64_t column = cell_of(x_m) - kSide / 2, row = cell_of(y_m) - kSide / 2;
  if (std::abs(column - first_column_) < kSide / 4 && std::abs(row - first_row_) < kSide / 4) {
    return;
  }
  const std::int64_t old_column = first_column_, old_row = first_row_;
  first_column_ = column;
  first_row_ = row;
  for (std::int64_t j = row; j < row + kSide; ++j) {
    for (std::int64_t i = column; i < column + kSide; ++i) {
      const bool known =
          i >= old_column && i < old_column + kSide && j >= old_row && j < old_row + kSide;
      if (!known) cell(i, j) = 0.0f;
    }
  }
}

void Footprints::move_feet() noexcept { feet_ = {}; }

// A foot digs; what it takes away lies in a ring around it, and slips.
void Footprints::press(const Foot& foot, const Step& step) noexcept {
  const double radius_m = step.radius_m;
  const std::int64_t column = cell_of(foot.x_m), row = cell_of(foot.y_m);
  const double heap_m = 2.0 * radius_m + kCell_m;
  const auto reach = static_cast<std::int64_t>(heap_m / kCell_m) + 1;
  double dug_m = 0.0;  // heights of all cells
  int around = 0;
  const auto for_each = [&](const auto& visit) {
    for (std::int64_t j = row - reach; j <= row + reach; ++j) {
      for (std::int64_t i = column - reach; i <= column + reach; ++i) {
        if (!holds(i, j)) continue;
        const double dx = middle_of(i) - foot.x_m, dy = middle_of(j) - foot.y_m;
        const double away2 = dx * dx + dy * dy;
        const bool under = away2 < radius_m * radius_m || (i == column && j == row);
        if (under || away2 < heap_m * heap_m) visit(cell(i, j), under, away2);
      }
    }
  };
  for_each([&](float& height_m, bool under, double away2) {
    if (!under) {
      ++around;
      return;
    }
    const double rise_m =
        step.flat ? 0.0 : radius_m - std::sqrt(std::max(radius_m * radius_m - away2, 0.0));
    const auto bottom_m = static_cast<float>(rise_m - foot.depth_m);
    if (height_m <= bottom_m) return;
    dug_m += static_cast<double>(height_m) - static_cast<double>(bottom_m);
    height_m = bottom_m;
  });
  if (around == 0 || dug_m == 0.0) return;
  for_each([&](float& height_m, bool under, double) {
    if (!under) height_m += static_cast<float>(dug_m / around);
  });
  const auto spread = static_cast<std::int64_t>(2.0 * foot.depth_m / (step.repose * kCell_m));
  slip(column, row, reach + std::clamp<std::int64_t>(spread, 1, kSide / 8), step.repose);
}

// Pairs of neighbours that are too steep share what is too much, until none is.
void Footprints::slip(std::int64_t column, std::int64_t row, std::int64_t reach,
                      double repose) noexcept {
  constexpr int kMostSweeps = 200;
  constexpr float kEnough_m = 1e-4f;
  const auto steepest = static_cast<float>(repose * kCell_m);
  const float steepest_diagonal = steepest * std::sqrt(2.0f);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    float worst_m = 0.0f;
    const auto share = [&](float& here, std::int64_t i, std::int64_t j, float most) {
      if (!holds(i, j)) return;
      float& there = cell(i, j);
      const float difference = here - there;
      const float over = std::fabs(difference) - most;
      if (!(over > 0.0f)) return;
      worst_m = std::max(worst_m, over);
      const float moved = std::copysign(0.5f * over, difference);
      here -= moved;
      there += moved;
    };
    for (std::int64_t j = row - reach; j <= row + reach; ++j) {
      for (std::int64_t i = column - reach; i <= column + reach; ++i) {
        if (!holds(i, j)) continue;
        float& here = cell(i, j);
        share(here, i + 1, j, steepest);
        share(here, i, j + 1, steepest);
        share(here, i + 1, j + 1, steepest_diagonal);
        share(here, i - 1, j + 1, steepest_diagonal);
      }
    }
    if (worst_m < kEnough_m) return;
  }
}

double Footprints::volume_m3() const noexcept {
  double sum_m = 0.0;
  for (const float height_m : height_m_) sum_m += static_cast<double>(height_m);
  return sum_m * kCell_m * kCell_m;
}

}  // namespace sandrunner::sim
