// SPDX-License-Identifier: BSD-3-Clause
// A small painter of line plots: stacked panels over a common x axis, to a PNG.
#pragma once

#include <cairo.h>

#include <memory>
#include <string>
#include <vector>

namespace sandrunner::plot {

struct Color {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
};

inline constexpr Color kInk{0.13, 0.15, 0.18};
inline constexpr Color kFaintInk{0.42, 0.45, 0.50};

/// A white picture. Its methods are what cairo lacks for lettering and for files; the rest is drawn
/// with `cairo()`.
class Canvas {
 public:
  Canvas(int width_px, int height_px);

  cairo_t* cairo() const { return context_.get(); }
  void set_color(const Color& color) const;
  /// Writes a line of text. `anchor`: which part of the text lies at x, from 0 (left end) to 1
  /// (right end); y is the base line.
  void text(double x_px, double y_px, const std::string& text, double size_px, double anchor,
            const Color& color = kInk, bool bold = false) const;
  double text_width(const std::string& text, double size_px, bool bold = false) const;
  /// The file is whole or not there; InputError if it cannot be written.
  void save_png(const std::string& path) const;

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context_;
};

/// One line, in the legend unless its name is empty. `y` has a value for every x of the figure; nan
/// is a gap.
struct Series {
  std::string name;
  Color color;
  std::vector<double> y;
  bool step = false;  ///< holds each value up to the next x
  bool dashed = false;
  bool markers = false;   ///< a disc at each value
  double width_px = 1.5;  ///< of the line
};

struct Panel {
  std::string title;
  std::string y_label;  ///< quantity and unit
  std::vector<Series> series;
  double least_range = 1e-3;  ///< of the y axis, so that noise about a constant is not magnified
  bool from_zero = false;     ///< the y axis begins at 0
};

/// A shaded range of x. The label stands above the panels of the views that have no title.
struct Span {
  double begin = 0.0, end = 0.0;
  Color color;
  std::string label;
};

/// A column of the figure: all panels over one range of x.
struct View {
  std::string title;
  double begin = 0.0, end = 1.0;
  double width_share = 1.0;
};

struct Figure {
  std::string title;
  std::string x_label;
  std::vector<double> x;  ///< ascending
  std::vector<Panel> panels;
  std::vector<Span> spans;
  std::vector<View> views;
  int width_px = 1800;
  int panel_height_px = 174;
};

/// The multiples of 1, 2 or 5 times a power of ten within [begin, end], as close as at most `most`
/// of them are.
std::vector<double> ticks(double begin, double end, int most);

/// "0.25": with as many digits as ticks `step` apart need.
std::string tick_label(double value, double step);

struct Point {
  double x = 0.0, y = 0.0;
};

/// What to draw of y(x) for x in [begin, end] on `columns` pixels: of the values in one pixel
/// column the first, least, greatest and last, in their order, so that peaks show; the neighbours
/// just outside, so that lines reach the edge; and a point of nan for each gap.
std::vector<Point> decimate(const std::vector<double>& x, const std::vector<double>& y,
                            double begin, double end, int columns);

/// Height of the PNG that `draw` writes.
int height_px(const Figure& figure);

/// Draws the figure; InputError if the file cannot be written.
void draw(const Figure& figure, const std::string& png_path);

}  // namespace sandrunner::plot
