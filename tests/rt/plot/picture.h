// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cairo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "rt/plot/plot.h"

namespace sandrunner {

struct Rgb {
  int red = 0, green = 0, blue = 0;
  bool operator==(const Rgb&) const = default;
};

/// A PNG from a file, by cairo's reader.
class Picture {
 public:
  explicit Picture(const std::string& path)
      : surface_(cairo_image_surface_create_from_png(path.c_str())) {
    EXPECT_EQ(cairo_surface_status(surface_), CAIRO_STATUS_SUCCESS) << path;
  }
  ~Picture() { cairo_surface_destroy(surface_); }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  int width() const { return cairo_image_surface_get_width(surface_); }
  int height() const { return cairo_image_surface_get_height(surface_); }
  Rgb at(int x, int y) const {
    const unsigned char* row =
        cairo_image_surface_get_data(surface_) + y * cairo_image_surface_get_stride(surface_);
    std::uint32_t pixel = 0;
    std::memcpy(&pixel, row + 4 * x, 4);
    return {static_cast<int>(pixel >> 16 & 0xff), static_cast<int>(pixel >> 8 & 0xff),
            static_cast<int>(pixel & 0xff)};
  }
  /// How many pixels of the rectangle have the colour, but for rounding.
  int count(const plot::Color& color, int left, int top, int right, int bottom) const {
    int found = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        const Rgb pixel = at(x, y);
        found += std::abs(pixel.red - color.red * 255.0) < 3.0 &&
                 std::abs(pixel.green - color.green * 255.0) < 3.0 &&
                 std::abs(pixel.blue - color.blue * 255.0) < 3.0;
      }
    }
    return found;
  }

 private:
  cairo_surface_t* surface_;
};

}  // namespace sandrunner
