// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/side_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "rt/base/fixed_text.h"
#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

using plot::Canvas;
using plot::Color;

constexpr double kPixelsPerMeter = 262.0;
constexpr double kBelowGround_m = 0.23;  ///< what is seen of the ground under the base
// Of a robot that bounds, the left legs move as the right ones do: seen squarely from the side they
// would hide behind them. So what lies to the left is drawn further to the front and up (an oblique
// projection), by these shares of its distance.
constexpr double kAheadPerLeft = 0.24, kUpPerLeft = 0.12;

constexpr Color kSky{0.93, 0.955, 0.98};
constexpr Color kNearLeg{0.10, 0.20, 0.33};
constexpr Color kFarLeg{0.47, 0.60, 0.74};
constexpr Color kBody{0.93, 0.52, 0.13};
constexpr Color kBodyEdge{0.60, 0.30, 0.05};

Rotation orientation(const RunRow& row) {
  const auto [w, x, y, z] = row.orientation_wxyz;
  return {w, x, y, z};
}

/// One view: from the right, a little from behind and above, at the base, forward to the right.
class SideView {
 public:
  SideView(const Canvas& canvas, const RunRecord& record, const RunRow& row, double left_px,
           double top_px)
      : canvas_(canvas), record_(record), row_(row), left_px_(left_px), top_px_(top_px) {
    const Vector3 forward = body_axes(orientation(row))[0];
    const double length = std::hypot(forward[0], forward[1]);
    if (length > 1e-6) heading_ = {forward[0] / length, forward[1] / length};
    ground_m_ = ground(0.0, 0.0);
  }

  void draw(double distance_m) const {
    cairo_t* cr = canvas_.cairo();
    cairo_save(cr);
    cairo_rectangle(cr, left_px_, top_px_, kSideViewWidth_px, kSideViewHeight_px);
    cairo_clip(cr);
    canvas_.set_color(kSky);
    cairo_paint(cr);
    draw_ground(true);
    draw_ground(false);
    draw_ruler(distance_m);
    draw_legs(true);
    draw_body();
    draw_legs(false);
    draw_caption();
    cairo_restore(cr);
    canvas_.set_color({0.75, 0.78, 0.82});
    cairo_set_line_width(cr, 1.0);
    cairo_rectangle(cr, left_px_ + 0.5, top_px_ + 0.5, kSideViewWidth_px - 1.0,
                    kSideViewHeight_px - 1.0);
    cairo_stroke(cr);
  }

 private:
  /// A point of the view: u to the right in the picture, z up in it, v to the robot's left, metres.
  struct ViewPoint {
    double u = 0.0, v = 0.0, z = 0.0;
  };

  ViewPoint view_point(const std::array<float, 3>& p) const {
    return view_point(Vector3{p[0], p[1], p[2]});
  }
  ViewPoint view_point(const Vector3& p) const {
    const double dx = p[0] - row_.position_m[0];
    const double dy = p[1] - row_.position_m[1];
    const double left = heading_[0] * dy - heading_[1] * dx;
    return {heading_[0] * dx + heading_[1] * dy + kAheadPerLeft * left, left,
            p[2] + kUpPerLeft * left};
  }
  double x_px(double u) const { return left_px_ + 0.5 * kSideViewWidth_px + kPixelsPerMeter * u; }
  double y_px(double z) const {
    return top_px_ + kSideViewHeight_px - kPixelsPerMeter * (z - ground_m_ + kBelowGround_m);
  }

  /// Height of the undisturbed surface.
  double ground(double u, double v) const {
    if (!record_.scene.ground_height_m) return 0.0;
    return record_.scene.ground_height_m(row_.position_m[0] + heading_[0] * u - heading_[1] * v,
                                         row_.position_m[1] + heading_[1] * u + heading_[0] * v);
  }

  /// A hole in the surface at u. Its shape is drawn, not simulated: as wide as the foot, walls of
  /// 60 deg.
  struct Dent {
    double u = 0.0, depth_m = 0.0;
    double at(double other_u, double radius_m) const {
      const double beyond_m = std::max(0.0, std::abs(other_u - u) - radius_m);
      return std::max(0.0, depth_m - beyond_m * std::numbers::sqrt3);
    }
  };

  /// Dents of the far or near feet: footprints so far, and where feet are in the ground now.
  std::vector<Dent> dents(bool far) const {
    constexpr double kFarthest_m =
        0.45;  // farther from the plane of the view they are of another path
    std::vector<Dent> result;
    for (const Footprint& print : record_.footprints) {
      if (print.t_s > row_.t_s) continue;
      const ViewPoint p = view_point(Vector3{print.x_m, print.y_m, 0.0});
      if ((p.v > 0.0) == far && std::abs(p.v) < kFarthest_m) result.push_back({p.u, print.depth_m});
    }
    for (std::size_t leg = far ? 0 : 1; leg < kNumLegs; leg += 2) {
      if (!record_.scene.granular_ground) continue;
      result.push_back({view_point(row_.foot_m[leg]).u, row_.penetration_m[leg]});
    }
    return result;
  }

  void draw_ground(bool far) const {
    cairo_t* cr = canvas_.cairo();
    double lateral_m = 0.0;
    for (std::size_t leg = far ? 0 : 1; leg < kNumLegs; leg += 2) {
      lateral_m += 0.5 * view_point(row_.hip_m[leg]).v;
    }
    const std::vector<Dent> holes = dents(far);
    cairo_new_path(cr);
    for (double px = -2.0; px <= kSideViewWidth_px + 2.0; px += 1.0) {
      const double u = (px - 0.5 * kSideViewWidth_px) / kPixelsPerMeter;
      double depth_m = 0.0;
      for (const Dent& dent : holes)
        depth_m = std::max(depth_m, dent.at(u, record_.scene.foot_radius_m));
      const double height_m = ground(u - kAheadPerLeft * lateral_m, lateral_m) - depth_m;
      cairo_line_to(cr, left_px_ + px, y_px(height_m + kUpPerLeft * lateral_m));
    }
    cairo_path_t* surface = cairo_copy_path(cr);
    cairo_line_to(cr, left_px_ + kSideViewWidth_px + 2.0, top_px_ + kSideViewHeight_px + 2.0);
    cairo_line_to(cr, left_px_ - 2.0, top_px_ + kSideViewHeight_px + 2.0);
    const bool sand = record_.scene.granular_ground;
    const Color near_fill = sand ? Color{0.90, 0.80, 0.60} : Color{0.80, 0.81, 0.83};
    const Color far_fill = sand ? Color{0.80, 0.68, 0.46} : Color{0.72, 0.73, 0.76};
    const Color edge = sand ? Color{0.60, 0.47, 0.25} : Color{0.45, 0.47, 0.50};
    canvas_.set_color(far ? far_fill : near_fill);
    cairo_fill(cr);
    cairo_append_path(cr, surface);
    cairo_path_destroy(surface);
    canvas_.set_color(edge);
    cairo_set_line_width(cr, far ? 0.8 : 1.6);
    cairo_stroke(cr);
  }

  /// Distance walked, every half metre.
  void draw_ruler(double distance_m) const {
    constexpr double kStep_m = 0.5;
    cairo_t* cr = canvas_.cairo();
    const double half_m = 0.5 * kSideViewWidth_px / kPixelsPerMeter;
    const double bottom_px = top_px_ + kSideViewHeight_px;
    const double first = std::ceil((distance_m - half_m) / kStep_m);
    constexpr int kMarks = static_cast<int>(kSideViewWidth_px / kPixelsPerMeter / kStep_m) + 1;
    for (int i = 0; i < kMarks; ++i) {
      const double mark = first + i;
      if (!(mark * kStep_m < distance_m + half_m)) break;
      const double at_px = std::floor(x_px(mark * kStep_m - distance_m)) + 0.5;
      cairo_set_line_width(cr, 1.0);
      canvas_.set_color(plot::kFaintInk);
      cairo_move_to(cr, at_px, bottom_px);
      cairo_line_to(cr, at_px, bottom_px - 6.0);
      cairo_stroke(cr);
      const double from_edge_px = std::min(at_px - left_px_, left_px_ + kSideViewWidth_px - at_px);
      if (from_edge_px < 22.0) continue;  // no room for the number
      canvas_.text(at_px, bottom_px - 10.0, plot::tick_label(mark * kStep_m, kStep_m) + " m", 12.0,
                   0.5, plot::kFaintInk);
    }
  }

  void draw_legs(bool far) const {
    cairo_t* cr = canvas_.cairo();
    const Color color = far ? kFarLeg : kNearLeg;
    cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
    for (std::size_t leg = far ? 0 : 1; leg < kNumLegs; leg += 2) {
      const ViewPoint hip = view_point(row_.hip_m[leg]);
      const ViewPoint knee = view_point(row_.knee_m[leg]);
      const ViewPoint foot = view_point(row_.foot_m[leg]);
      const auto link = [&](const ViewPoint& from, const ViewPoint& to, double width_m) {
        cairo_set_line_width(cr, kPixelsPerMeter * width_m);
        cairo_move_to(cr, x_px(from.u), y_px(from.z));
        cairo_line_to(cr, x_px(to.u), y_px(to.z));
        cairo_stroke(cr);
      };
      canvas_.set_color(color);
      link(knee, foot, 0.026);
      link(hip, knee, 0.058);
      disc(foot, record_.scene.foot_radius_m, color);
      disc(hip, 0.046, color);
      disc(hip, 0.018, kSky);
      disc(knee, 0.011, kSky);
      disc(foot, 0.4 * record_.scene.foot_radius_m, kSky);
    }
  }

  void disc(const ViewPoint& center, double radius_m, const Color& color) const {
    canvas_.set_color(color);
    cairo_arc(canvas_.cairo(), x_px(center.u), y_px(center.z), kPixelsPerMeter * radius_m, 0.0,
              2.0 * std::numbers::pi);
    cairo_fill(canvas_.cairo());
  }

  /// Part of the base box: from `rear` to `front`, -1 to 1, of its length.
  void draw_box(double rear, double front, const Color& color) const {
    const std::array<Vector3, 3> axes = body_axes(orientation(row_));
    std::array<ViewPoint, 8> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector3 side = {(i & 1) != 0 ? front : rear, (i & 2) != 0 ? 1.0 : -1.0,
                            (i & 4) != 0 ? 1.0 : -1.0};
      Vector3 p = row_.position_m;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double along_m = record_.scene.base_box_center_m[axis] +
                               0.5 * side[axis] * record_.scene.base_box_size_m[axis];
        for (std::size_t k = 0; k < 3; ++k) p[k] += along_m * axes[axis][k];
      }
      corners[i] = view_point(p);
    }
    constexpr std::array<std::array<std::size_t, 4>, 6> kFaces = {
        {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}}};
    cairo_t* cr = canvas_.cairo();
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_width(cr, 3.0);
    for (const bool edge : {true, false}) {  // of the edges only the outline stays
      canvas_.set_color(edge ? kBodyEdge : color);
      for (const auto& face : kFaces) {
        cairo_new_path(cr);
        for (const std::size_t i : face) cairo_line_to(cr, x_px(corners[i].u), y_px(corners[i].z));
        cairo_close_path(cr);
        edge ? cairo_stroke(cr) : cairo_fill(cr);
      }
    }
  }

  void draw_body() const {
    draw_box(-1.0, 1.0, kBody);
    draw_box(0.82, 1.0, kBodyEdge);  // tells front from rear
  }

  void draw_caption() const {
    canvas_.text(left_px_ + 10.0, top_px_ + 22.0, fmt::format("{:.2f} s", row_.t_s), 15.0, 0.0,
                 plot::kInk, true);
    canvas_.text(left_px_ + kSideViewWidth_px - 10.0, top_px_ + 22.0,
                 fixed_text(row_.motion[0], 2) + " m/s", 15.0, 1.0);
  }

  const Canvas& canvas_;
  const RunRecord& record_;
  const RunRow& row_;
  double left_px_;
  double top_px_;
  std::array<double, 2> heading_ = {1.0, 0.0};
  double ground_m_ = 0.0;
};

}  // namespace

void draw_side_view(const plot::Canvas& canvas, const RunRecord& record, const RunRow& row,
                    double distance_m, double left_px, double top_px) {
  SideView(canvas, record, row, left_px, top_px).draw(distance_m);
}

}  // namespace sandrunner
